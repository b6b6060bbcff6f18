/** From the hand to the eye: what time passes until a picture shows what somebody did, by stage. */

import type { Frame } from "@culet/protocol/frame";
import type { Reach, Reached } from "@culet/protocol/messages";
import type { SessionEvent } from "../session/events";
import type { Arrival } from "./frame-history";

/** In turn: to the engine, until the frame is begun, simulating, rendering, encoding, back, and decoding and painting. */
export const DELAY_STAGES = ["way", "wait", "simulate", "render", "encode", "network", "paint"] as const;

export interface Delay {
  /** From the input to the painted picture, ms. */
  total: number;
  /** Milliseconds of each of DELAY_STAGES. */
  stages: readonly number[];
}

/** Delays that are kept. */
const KEPT = 1000;
/** An answer that is not there after so many ms will not come: the connection was lost. */
const PATIENCE_MS = 5000;
/** Frames that may have come before the answer. */
const BEFORE = 4;
/** What time makes of these is seen with a later step than the session has when they are done. */
const OF_MOTION: ReadonlySet<SessionEvent["type"]> = new Set(["push", "toggle_fall", "balance"]);

interface Shown {
  frame: Frame;
  arrival: Arrival;
  painted: number;
}

interface Pending {
  began: number;
  /** ms, when the answer came; null before. */
  answered: number | null;
  step: number;
}

export class Delays {
  /** Whether anything is asked; without, nothing is sent. */
  on = false;
  readonly kept: Delay[] = [];
  private readonly ask: (question: Reach) => void;
  private number = 0;
  private pending: Pending | null = null;
  private seen: Shown[] = [];

  constructor(ask: (question: Reach) => void) {
    this.ask = ask;
  }

  /** An event was sent at `now` for an input of the time `began`, ms. One is followed at a time. */
  sent({ type }: SessionEvent, began: number, now: number): void {
    if (!this.on || OF_MOTION.has(type)) return;
    if (this.pending && now - this.pending.began < PATIENCE_MS) return;
    this.number += 1;
    this.pending = { began, answered: null, step: 0 };
    this.seen = [];
    this.ask({ type: "reach", number: this.number });
  }

  heard({ number, step }: Reached, now: number): Delay | null {
    if (!this.pending || number !== this.number) return null;
    this.pending.answered = now;
    this.pending.step = step;
    return this.found();
  }

  /** A frame was painted at that time, ms. */
  painted(frame: Frame, arrival: Arrival, painted: number): Delay | null {
    if (!this.pending) return null;
    this.seen = [...this.seen, { frame, arrival, painted }].slice(-BEFORE);
    return this.found();
  }

  private found(): Delay | null {
    const { pending } = this;
    if (!pending || pending.answered === null) return null;
    const first = this.seen.find(({ frame }) => Number(frame.step) >= pending.step);
    if (!first) return null;
    this.pending = null;
    const delay = delayOf(pending.began, pending.answered, first);
    this.kept.push(delay);
    this.kept.splice(0, this.kept.length - KEPT);
    return delay;
  }
}

/** The engine's own times are in the header. What nobody measures, the wait for the frame, is what is left. */
function delayOf(began: number, answered: number, { frame, arrival, painted }: Shown): Delay {
  const { simulateMs, renderMs, samples, encodeMs } = frame;
  const total = painted - began;
  const way = (answered - began) / 2;
  const network = (arrival.roundTripMs ?? 0) / 2;
  const paint = arrival.decodeMs + painted - arrival.time;
  const known = [simulateMs, renderMs / samples, encodeMs, network, paint];
  const wait = total - way - known.reduce((sum, stage) => sum + stage, 0);
  return { total, stages: [way, Math.max(0, wait), ...known] };
}
