/** A film by the browser's recorder, which every page may use. Loaded where there is no encoder. */

import {
  BlobSource,
  BufferTarget,
  Conversion,
  Input,
  MP4,
  Mp4OutputFormat,
  Output,
  WEBM,
  WebMOutputFormat,
} from "mediabunny";
import { words } from "../words/words";
import type { ClipFrame } from "./clip-frames";
import { clipSize, RATE } from "./clip-timeline";
import { Easel } from "./easel";
import { type Film, filmIn, type Making } from "./film";

/** By what plays on most devices. */
const TYPES = ["video/mp4;codecs=avc1.640028", "video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];
/** Bits a second: facets have many sharp edges. */
const BITS = 12e6;

/** As fast as it is seen: recorders keep their own time. */
export async function recordedFilm(timeline: readonly ClipFrame[], making: Making): Promise<Film> {
  const mimeType = TYPES.find((type) => MediaRecorder.isTypeSupported(type));
  if (mimeType === undefined) throw new Error(words.clip.unable);
  const easel = new Easel(clipSize(timeline));
  await easel.show(timeline[0] as ClipFrame);
  const stream = easel.canvas.captureStream(RATE);
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const stopped = new Promise<void>((resolve, reject) => {
    recorder.onstop = () => resolve();
    recorder.onerror = (event) => reject(new Error(words.clip.failed(event.type)));
  });
  recorder.start();
  const began = performance.now();
  try {
    for (let part = 0; part < 1; ) {
      making.signal.throwIfAborted();
      part = ((performance.now() - began) * RATE) / 1000 / timeline.length;
      await easel.show(timeline[Math.min(Math.floor(part * timeline.length), timeline.length - 1)] as ClipFrame, true);
      making.progress(Math.min(part, 1));
      await new Promise((resolve) => setTimeout(resolve, 1000 / RATE));
    }
  } finally {
    recorder.stop();
    for (const track of stream.getTracks()) track.stop();
    easel.close();
  }
  await stopped;
  const ending = mimeType.startsWith("video/mp4") ? "mp4" : "webm";
  return withLength(new Blob(parts, { type: `video/${ending}` }), ending);
}

/** The same film with its length written in it, which recorders leave out: players could not wind it otherwise. */
async function withLength(file: Blob, ending: Film["ending"]): Promise<Film> {
  const target = new BufferTarget();
  const input = new Input({ source: new BlobSource(file), formats: [MP4, WEBM] });
  const format = ending === "mp4" ? new Mp4OutputFormat() : new WebMOutputFormat();
  const output = new Output({ format, target });
  await (await Conversion.init({ input, output })).execute();
  return filmIn(target.buffer, ending);
}
