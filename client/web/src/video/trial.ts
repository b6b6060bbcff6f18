/** Whether a browser's decoder can be trusted: it says that it decodes a codec, and shows a known picture's pixels. */

import { bitmapOf } from "./bitmap";
import { codecString, type VideoCodec } from "./codec-string";
import { PacketDecoder } from "./packet-decoder";
import { PATCHES, SIDE, TRIAL_FRAMES } from "./trial-frames";

/** Levels of 255 by which a channel may differ: 3 are the encoder's, 4:2:0 makes over 100 of it at the stripes. */
export const TOLERANCE = 10;

/** The largest difference of a channel between RGBA pixels and the trial's picture. */
export function largestDifference(pixels: Uint8ClampedArray): number {
  let largest = 0;
  for (let y = 0; y < SIDE; y += 1) {
    for (let x = 0; x < SIDE; x += 1) {
      const stripe = x % 2 === 0 ? PATCHES[0] : PATCHES[2];
      const wanted = y < SIDE / 2 ? PATCHES[Math.floor((x * PATCHES.length) / SIDE)] : stripe;
      for (const [channel, level] of (wanted ?? []).entries()) {
        const got = pixels[4 * (y * SIDE + x) + channel] ?? Number.POSITIVE_INFINITY;
        largest = Math.max(largest, Math.abs(got - level));
      }
    }
  }
  return largest;
}

/** Those of the codecs, in their order, that this browser decodes as it should. */
export async function trusted(codecs: readonly VideoCodec[]): Promise<VideoCodec[]> {
  const passed: VideoCodec[] = [];
  for (const codec of codecs) {
    try {
      if (await passes(codec)) passed.push(codec);
    } catch {
      // a decoder that fails is not trusted
    }
  }
  return passed;
}

async function passes(codec: VideoCodec): Promise<boolean> {
  const data = Uint8Array.from(atob(TRIAL_FRAMES[codec]), (byte) => byte.charCodeAt(0));
  const name = codecString(codec, data);
  if (name === null || !(await VideoDecoder.isConfigSupported({ codec: name })).supported) return false;
  const decoder = new PacketDecoder();
  try {
    const bitmap = bitmapOf(await decoder.decode({ codec, isKey: true, width: SIDE, height: SIDE, data }));
    const canvas = new OffscreenCanvas(SIDE, SIDE);
    const context = canvas.getContext("2d", { alpha: false, willReadFrequently: true });
    if (!context) return false;
    context.drawImage(bitmap, 0, 0);
    bitmap.close();
    return largestDifference(context.getImageData(0, 0, SIDE, SIDE).data) <= TOLERANCE;
  } finally {
    decoder.close();
  }
}
