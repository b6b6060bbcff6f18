/** The pictures of the last seconds as they came, for clips: bounded in time and in bytes. */

import { Codec, Flag, type Frame } from "@culet/protocol/frame";

/** ms that a clip lasts at most. */
export const LONGEST_MS = 10_000;
/** Bytes of pictures that are kept: ten seconds of full HD at 30 pictures a second, where each has 200 kB. */
export const MOST_BYTES = 64 * 2 ** 20;

const MIME = { [Codec.JPEG]: "image/jpeg", [Codec.PNG]: "image/png" } as const;

/** A picture, and when it came, ms. */
export interface ClipFrame {
  time: number;
  step: bigint;
  atRest: boolean;
  width: number;
  height: number;
  /** As it came: encoded, and in what. */
  payload: Uint8Array<ArrayBuffer>;
  type: string;
}

export type TakenFrame = Pick<Frame, "step" | "flags" | "width" | "height" | "codec" | "payload">;

export class ClipFrames {
  private kept: ClipFrame[] = [];
  private bytes = 0;

  /** A frame is on the screen, at a time in ms. A better picture of what was seen at rest takes the place of that one. */
  take({ step, flags, width, height, codec, payload }: TakenFrame, time: number): void {
    const atRest = (flags & Flag.MOVING) === 0;
    const last = this.kept.at(-1);
    const better = atRest && last?.atRest === true && last.step === step;
    const frame = { time: better ? last.time : time, step, atRest, width, height, payload, type: MIME[codec] };
    if (better) this.drop(this.kept.length - 1);
    this.kept.push(frame);
    this.bytes += payload.byteLength;
    // The one before the first of the last seconds is what was seen when they began.
    while (this.kept.length > 1 && (this.bytes > MOST_BYTES || (this.kept[1]?.time ?? 0) <= frame.time - LONGEST_MS)) {
      this.drop(0);
    }
  }

  /** What was seen from one time to another, ms, beginning with what was seen at first. */
  between(from: number, to: number): ClipFrame[] {
    const first = this.kept.findLastIndex(({ time }) => time <= from);
    return this.kept.slice(Math.max(first, 0)).filter(({ time }) => time <= to);
  }

  /** When the last picture came that was another one, ms; null before there is one. */
  get lastTime(): number | null {
    return this.kept.at(-1)?.time ?? null;
  }

  private drop(index: number): void {
    for (const { payload } of this.kept.splice(index, 1)) this.bytes -= payload.byteLength;
  }
}
