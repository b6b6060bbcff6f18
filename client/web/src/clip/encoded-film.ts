/** A film by the browser's encoders: picture by picture, as fast as they are. */

import {
  BufferTarget,
  CanvasSource,
  getFirstEncodableVideoCodec,
  Mp4OutputFormat,
  Output,
  QUALITY_HIGH,
  type VideoCodec,
  WebMOutputFormat,
} from "mediabunny";
import type { ClipFrame } from "./clip-frames";
import { clipSize, RATE } from "./clip-timeline";
import { Easel } from "./easel";
import { type Film, filmIn, type Making } from "./film";

/** By what plays on most devices. */
const CODECS: VideoCodec[] = ["avc", "vp9", "av1", "vp8"];

/** Null if the browser encodes nothing that a film can be made of. */
export async function encodedFilm(timeline: readonly ClipFrame[], making: Making): Promise<Film | null> {
  const size = clipSize(timeline);
  const codec = await getFirstEncodableVideoCodec(CODECS, size);
  if (codec === null) return null;
  const easel = new Easel(size);
  const ending = codec === "avc" ? "mp4" : "webm";
  const target = new BufferTarget();
  const format = ending === "mp4" ? new Mp4OutputFormat() : new WebMOutputFormat();
  const output = new Output({ format, target });
  const source = new CanvasSource(easel.canvas, { codec, quality: QUALITY_HIGH });
  output.addVideoTrack(source, { frameRate: RATE });
  await output.start();
  try {
    for (const [tick, frame] of timeline.entries()) {
      making.signal.throwIfAborted();
      await easel.show(frame);
      await source.add(tick / RATE, 1 / RATE);
      making.progress((tick + 1) / timeline.length);
    }
    await output.finalize();
  } catch (error) {
    await output.cancel();
    throw error;
  } finally {
    easel.close();
  }
  return filmIn(target.buffer, ending);
}
