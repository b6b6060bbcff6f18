/** The pictures of the last seconds as they came, for clips: bounded in time and in bytes. */

import { Flag, type Frame } from "@culet/protocol/frame";
import { pictureType, videoCodec } from "../video/frame-decoder";
import type { VideoPacket } from "../video/packet-decoder";

/** ms that a clip lasts at most. */
export const LONGEST_MS = 10_000;
/** Bytes of pictures that are kept: ten seconds of full HD at 30 pictures a second, where each has 200 kB. */
export const MOST_BYTES = 64 * 2 ** 20;

/** A picture, and when it came, ms. */
export interface ClipFrame {
  time: number;
  step: bigint;
  atRest: boolean;
  width: number;
  height: number;
  /** As it came: a picture of its own, or a packet of video. */
  content: { payload: Uint8Array<ArrayBuffer>; type: string } | Packet;
}

export interface Packet extends VideoPacket {
  /** Number of its frame. */
  sequence: number;
  /** That has to be decoded before it; null of a key frame. Kept as long as one that needs it. */
  before: Packet | null;
}

export type TakenFrame = Pick<
  Frame,
  "step" | "flags" | "width" | "height" | "codec" | "payload" | "sequence" | "dependsOn"
>;

export class ClipFrames {
  private kept: ClipFrame[] = [];
  private bytes = 0;
  /** Of the video, as it is decoded. */
  private packet: Packet | null = null;

  /** A frame is on the screen, at a time in ms. A better picture of what was seen at rest takes the place of that one. */
  take(taken: TakenFrame, time: number): void {
    const { step, flags, width, height } = taken;
    const content = this.contentOf(taken);
    if (!content) return;
    const atRest = (flags & Flag.MOVING) === 0;
    const last = this.kept.at(-1);
    const better = atRest && last?.atRest === true && last.step === step;
    const frame = { time: better ? last.time : time, step, atRest, width, height, content };
    if (better) this.drop(this.kept.length - 1);
    this.kept.push(frame);
    this.bytes += bytesOf(frame);
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
    for (const frame of this.kept.splice(index, 1)) this.bytes -= bytesOf(frame);
  }

  /** Null: of video whose frame before is not known. */
  private contentOf(taken: TakenFrame): ClipFrame["content"] | null {
    const { width, height, payload, sequence, dependsOn, flags } = taken;
    const type = pictureType(taken);
    if (type !== undefined) return { payload, type };
    const codec = videoCodec(taken);
    const isKey = (flags & Flag.KEY) !== 0;
    if (codec === undefined || !(isKey || this.packet?.sequence === dependsOn)) return null;
    this.packet = { codec, isKey, width, height, data: payload, sequence, before: isKey ? null : this.packet };
    return this.packet;
  }
}

function bytesOf({ content }: ClipFrame): number {
  return ("payload" in content ? content.payload : content.data).byteLength;
}
