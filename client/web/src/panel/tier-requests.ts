/** When the server is asked about the tiers of a stone: seldom, and again where it was busy. */

import type { JsonObject } from "@culet/protocol/messages";
import type { TierAngle } from "../session/answers";
import { isPassing, ProblemError } from "../session/rest";
import { kindOf, type ListTiers, othersOf, shapeOf } from "./tiers";

/** ms after which is asked again what the server refused because it was busy or not there. */
export const RETRY_MS = 2000;
/** ms for which a pointer or the focus has to stay on a slider: one that passes over all of them asks for none. */
export const STAY_MS = 150;

type Timer = ReturnType<typeof setTimeout>;

/** Whether the server may answer in a while. */
export function passes(error: unknown): boolean {
  return error instanceof ProblemError && isPassing(error);
}

export interface ListHearer {
  /** The tiers of that scene's stone; by now it may have other proportions. */
  listed: (tiers: readonly TierAngle[], scene: JsonObject) => void;
  /** No list of that scene's stone, which is the one that is there. */
  failed: (error: unknown, scene: JsonObject) => void;
}

/** Asks for the list of the stone's tiers, once at a time, while somebody looks at it. */
export class ListRequests {
  private readonly list: ListTiers;
  private readonly hearer: ListHearer;
  private scene: JsonObject | null = null;
  private looking = false;
  /** What the list is of, or will be. */
  private asked = "";
  private asking = false;
  private later: Timer | undefined;

  constructor(list: ListTiers, hearer: ListHearer) {
    this.list = list;
    this.hearer = hearer;
  }

  /** The stone as it is, and whether somebody looks at its tiers. */
  look(scene: JsonObject | null, looking: boolean): void {
    if (kindOf(scene) !== kindOf(this.scene)) this.asked = ""; // its list is kept by nobody
    this.scene = scene;
    this.looking = looking;
    this.refresh();
  }

  private refresh(): void {
    const { scene } = this;
    const shape = shapeOf(scene);
    if (!scene || shape === "" || shape === this.asked) return;
    if (!this.looking || this.asking || this.later !== undefined) return;
    this.asked = shape;
    this.asking = true;
    void this.ask(scene).finally(() => {
      this.asking = false;
      this.refresh();
    });
  }

  private async ask(scene: JsonObject): Promise<void> {
    try {
      const tiers = await this.list(scene, null);
      if (this.isThere(scene)) this.hearer.listed(tiers, scene);
    } catch (error) {
      if (passes(error)) this.askLater();
      if (this.isThere(scene)) this.hearer.failed(error, scene);
    }
  }

  /** Whether the stone is still there that was asked about. */
  private isThere(scene: JsonObject): boolean {
    return kindOf(scene) === kindOf(this.scene);
  }

  private askLater(): void {
    this.asked = "";
    this.later = setTimeout(() => {
      this.later = undefined;
      this.refresh();
    }, RETRY_MS);
  }
}

/** How somebody is about to use a slider. */
export type By = "focus" | "pointer";

/** The one question that waits or is asked. */
interface Turn {
  tier: string;
  /** What the answer depends on. */
  of: string;
  giveUp: AbortController;
  timer: Timer | undefined;
}

/**
 * Asks for the ends at which meets are kept of the tiers that somebody is about to turn, one tier at a time: they take the
 * server a moment.
 */
export class ReachRequests {
  private readonly list: ListTiers;
  private readonly reached: (tier: string) => void;
  private scene: JsonObject | null = null;
  private readonly used: Record<By, string | null> = { focus: null, pointer: null };
  /** Newest answers by tiers; null where the server has none. */
  private readonly answers = new Map<string, { of: string; ends: TierAngle | null }>();
  private turn: Turn | null = null;

  /** `reached` is told of each tier whose ends have come. */
  constructor(list: ListTiers, reached: (tier: string) => void) {
    this.list = list;
    this.reached = reached;
  }

  look(scene: JsonObject | null): void {
    this.scene = scene;
    this.refresh();
  }

  /** That tier is about to be turned, or none is. */
  use(by: By, tier: string | null): void {
    this.used[by] = tier;
    this.refresh();
  }

  /** The tier with the ends that it has among the others as they are; null where they are not known. */
  ends(tier: string): TierAngle | null {
    const answer = this.answers.get(tier);
    return answer?.of === othersOf(this.scene, tier) ? answer.ends : null;
  }

  private refresh(): void {
    if (this.turn && this.isWanted(this.turn)) return;
    clearTimeout(this.turn?.timer);
    this.turn?.giveUp.abort();
    this.turn = null;
    const tier = [this.used.focus, this.used.pointer].find((each) => each !== null && !this.isAnswered(each));
    if (typeof tier !== "string") return;
    this.turn = { tier, of: othersOf(this.scene, tier), giveUp: new AbortController(), timer: undefined };
    this.askIn(STAY_MS, this.turn);
  }

  private isWanted({ tier, of }: Turn): boolean {
    return Object.values(this.used).includes(tier) && of === othersOf(this.scene, tier);
  }

  private isAnswered(tier: string): boolean {
    return this.answers.get(tier)?.of === othersOf(this.scene, tier);
  }

  private askIn(ms: number, turn: Turn): void {
    turn.timer = setTimeout(() => void this.ask(turn), ms);
  }

  private async ask(turn: Turn): Promise<void> {
    const { tier, of, giveUp } = turn;
    let ends: TierAngle | null = null;
    try {
      const tiers = await this.list(this.scene ?? {}, tier, giveUp.signal);
      ends = tiers.find((each) => String(each.tier) === tier) ?? null;
    } catch (error) {
      if (giveUp.signal.aborted) return;
      if (passes(error)) return this.askIn(RETRY_MS, turn);
    }
    if (giveUp.signal.aborted) return;
    this.answers.set(tier, { of, ends }); // without ends an angle beyond is refused with the server's reason
    this.turn = null;
    if (ends) this.reached(tier);
    this.refresh();
  }
}
