/** What a clip shows when: pictures came as they could, and a film has one size and a picture every thirtieth of a second. */

import { type PictureSize, pictureSize } from "../picture/picture-size";
import type { ClipFrame } from "./clip-frames";

/** Pictures a second: what films on the web have, and as many as the server sends at most where it is balanced. */
export const RATE = 30;

/** The pictures of a clip in turn, RATE of them a second, from one time to another, ms. At least one. */
export function timeline(frames: readonly ClipFrame[], from: number, to: number): ClipFrame[] {
  const count = Math.max(1, Math.round(((to - from) * RATE) / 1000));
  let index = 0;
  return Array.from({ length: count }, (_, tick) => {
    const now = from + (tick * 1000) / RATE;
    while ((frames[index + 1]?.time ?? Number.POSITIVE_INFINITY) <= now) index += 1;
    return frames[index] as ClipFrame;
  });
}

/** The size of a clip: of its largest picture, in pairs of pixels, since encoders halve their colours' resolution. */
export function clipSize(frames: readonly ClipFrame[]): PictureSize {
  const largest = frames.reduce((a, b) => (b.width * b.height > a.width * a.height ? b : a));
  const { width, height } = pictureSize(largest.width, largest.height);
  return { width: 2 * Math.round(width / 2), height: 2 * Math.round(height / 2) };
}
