/** What keeps moving frames from being more, or better ones. */

import { Flag, type Frame } from "@culet/protocol/frame";

export type Bottleneck = "rendering" | "network" | "browser";

const WINDOW_MS = 2000;
/** Part of the time that this browser decodes, from which on it is busy with that. */
const BUSY = 0.7;
/** Part of the frames made that did not come, from which on the way here is too narrow for them. */
const SKIPPED = 0.25;

type Seen = Pick<Frame, "flags" | "sequence" | "samples">;

export class BottleneckMeter {
  private frames: { time: number; made: number; decodeMs: number; thrifty: boolean }[] = [];
  private last: number | null = null;

  /** A frame is on the screen, `time` in milliseconds. */
  shown({ flags, sequence, samples }: Seen, time: number, decodeMs: number): void {
    const made = this.last === null ? 1 : (sequence - this.last) | 0;
    this.last = sequence;
    if (samples > 1) this.frames = [];
    else this.frames.push({ time, made: made > 0 ? made : 1, decodeMs, thrifty: (flags & Flag.THRIFTY) !== 0 });
  }

  /** Null of a picture at rest, and of one frame. */
  at(time: number): Bottleneck | null {
    this.frames = this.frames.filter((frame) => frame.time > time - WINDOW_MS);
    const first = this.frames[0];
    const latest = this.frames.at(-1);
    if (!first || !latest || first === latest) return null;
    const decoding = sum(this.frames.slice(1).map(({ decodeMs }) => decodeMs));
    if (decoding > BUSY * (latest.time - first.time)) return "browser";
    const made = sum(this.frames.map((frame) => frame.made));
    return latest.thrifty || this.frames.length < (1 - SKIPPED) * made ? "network" : "rendering";
  }
}

function sum(values: readonly number[]): number {
  return values.reduce((total, value) => total + value, 0);
}
