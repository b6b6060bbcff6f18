/** When the grades of the stone are asked for: while they are looked at, once the stone stays as it is, until they come. */

import type { JsonObject } from "@culet/protocol/messages";
import { isPassing, ProblemError } from "../session/rest";
import { pauseBefore } from "../session/stream";
import { reasonOf } from "../signs/complaints";

/** ms without a change of the stone before its grades are asked for: a slider that is dragged changes it all the time. */
export const PATIENCE_MS = 250;

export interface GradingWorld {
  /** The server's answer for the stone as it is; `signal` gives up on it. */
  ask: (tilt: boolean, signal: AbortSignal) => Promise<JsonObject>;
  /** Whether anybody looks at the grades. */
  seen: () => boolean;
  /** An answer is waited for, or is there. */
  busy: (on: boolean) => void;
  /** What is shown is of the stone before its last change. */
  outdated: () => void;
  show: (answer: JsonObject, signal: AbortSignal) => Promise<void>;
  fail: (why: string) => void;
}

export class Grading {
  private readonly world: GradingWorld;
  /** What is shown, or will be, is of this stone. */
  private asked = "";
  /** Its grades could not be had when they were last asked for. */
  private failed = false;
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private giveUp = new AbortController();

  constructor(world: GradingWorld) {
    this.world = world;
  }

  /** Grades are looked at again: those that could not be had may be there now. */
  reopened(stone: string): void {
    if (this.failed) this.asked = "";
    this.refresh(stone);
  }

  /** Ask, if what is shown is of another stone, once the stone stays as it is. */
  refresh(stone: string): void {
    if (stone === this.asked || stone === "") return;
    this.asked = stone;
    this.failed = false;
    this.giveUp.abort();
    clearTimeout(this.waiting);
    this.world.busy(false);
    this.world.outdated();
    this.waiting = setTimeout(() => this.request(false), PATIENCE_MS);
  }

  /** Ask at once, and for tilt curves too if they are wanted; after `tries` that failed, since the server was not ready. */
  async request(tilt: boolean, tries = 0): Promise<void> {
    clearTimeout(this.waiting);
    this.giveUp.abort();
    this.giveUp = new AbortController();
    const { signal } = this.giveUp;
    this.failed = false;
    this.world.busy(true);
    try {
      await this.world.show(await this.world.ask(tilt, signal), signal);
    } catch (error) {
      if (signal.aborted) return;
      this.failed = true;
      this.world.fail(reasonOf(error));
      if (error instanceof ProblemError && isPassing(error)) this.later(tilt, tries);
    } finally {
      if (!signal.aborted) this.world.busy(false);
    }
  }

  /** Try again after a pause, if anybody still looks at the grades. */
  private later(tilt: boolean, tries: number): void {
    this.waiting = setTimeout(() => {
      if (this.world.seen()) void this.request(tilt, tries + 1);
    }, pauseBefore(tries));
  }
}
