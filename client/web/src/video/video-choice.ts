/**
 * Whether what moves is to come as video. Video has a third of the bytes of pictures of their own, but takes both
 * sides some times as long to encode and to decode: it pays where the way here is too narrow for pictures.
 */

import { Flag, type Frame } from "@culet/protocol/frame";
import type { Bottleneck } from "../meter/bottleneck";

/**
 * For which the way must be too narrow. A browser on a busy machine acknowledges late, which looks like a narrow way for
 * a second or two.
 */
export const NARROW_MS = 4000;
/** Frames further apart than this are not of the same motion. */
const PAUSE_MS = 2000;
/** After so long pictures of their own are tried again, once things rest: the way may be another one by then. */
export const AGAIN_MS = 60_000;

type Seen = Pick<Frame, "flags" | "samples">;

export class VideoChoice {
  /** Video is asked for. */
  on: boolean;
  /** The user wants few bytes. */
  private readonly saving: boolean;
  private narrowSince: number | null = null;
  private seenAt = Number.NEGATIVE_INFINITY;
  private reducedAt = Number.NEGATIVE_INFINITY;

  constructor(saving = false) {
    this.on = this.saving = saving;
  }

  /** A frame is on the screen, at `time` in milliseconds, and frames wait for that; whether the choice is another one now. */
  shown({ flags, samples }: Seen, time: number, waitsFor: Bottleneck | null): boolean {
    const before = this.on;
    const moving = (flags & Flag.MOVING) !== 0 || samples === 1;
    if (!moving) this.rest(time);
    else if (this.on) this.watch(flags, time);
    else this.judge(time, waitsFor);
    return this.on !== before;
  }

  private judge(time: number, waitsFor: Bottleneck | null): void {
    if (waitsFor !== "network" || time - this.seenAt > PAUSE_MS) this.narrowSince = null;
    this.seenAt = time;
    if (waitsFor !== "network") return;
    this.narrowSince ??= time;
    if (time - this.narrowSince >= NARROW_MS) this.turn(true, time);
  }

  private watch(flags: number, time: number): void {
    if (flags & Flag.THRIFTY) this.reducedAt = time;
  }

  private rest(time: number): void {
    this.narrowSince = null;
    if (this.on && !this.saving && time - this.reducedAt > AGAIN_MS) this.turn(false, time);
  }

  private turn(on: boolean, time: number): void {
    this.on = on;
    this.narrowSince = null;
    this.reducedAt = time;
  }
}

/** Whether this browser's user asked for few bytes (Save-Data, https://wicg.github.io/savedata/). */
export function savesData(): boolean {
  const told = (globalThis as { navigator?: { connection?: { saveData?: boolean } } }).navigator;
  return told?.connection?.saveData === true;
}
