/** The status line's words. */

import { Flag, type Frame } from "@culet/protocol/frame";
import { viewersText } from "./view-state";

export interface Status {
  framesPerSecond: number;
  frame: Omit<Frame, "payload"> | null;
  roundTripMs: number | null;
  viewers: number;
}

/** At most three significant digits before it gets noisy: 0.12, 1.75, 31.5, 2049. */
export function milliseconds(value: number): string {
  return value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toFixed(2);
}

/** Two significant digits, without an exponent as long as a reader can count the zeros. */
export function significant(value: number): string {
  return value === 0 || value >= 1e-4 ? String(Number(value.toPrecision(2))) : value.toExponential(1);
}

/** What the two kinds of error are of, for tooltips. */
export const ERROR_MEANINGS = {
  frontier:
    "What settings like this moving frame's miss of the default scene at 1280\u00d7720, as measured beforehand: " +
    "a single sample does not show its own error.",
  estimated: "What this picture at rest still misses, estimated from the two halves of its samples.",
  shown:
    "How far this picture is from a perfect one as a screen shows it, from 0 to 1, root mean square over pixels and " +
    "colours: what more samples would take away. From 0.004 on no difference is seen.",
} as const;

type RestingFrame = Pick<Frame, "flags" | "shownError" | "restError">;

/** A moving picture's error is not its own: it is what the measured front says of its settings. */
function errorName({ flags }: Pick<Frame, "flags">): string {
  return flags & Flag.FRONTIER ? "frontier's error" : "error";
}

/** Of the light that stones throw on floor and walls at most this part is missing. */
function lightText({ flags, lightCut }: Pick<Frame, "flags" | "lightCut">): string {
  if (flags & Flag.SHADOWS_ONLY) return "shadows without caustics";
  return `caustics lack at most ${significant(100 * lightCut)} %`;
}

/** How good a picture at rest is, and, if that is another thing, how good it was to be. */
function shownErrorText({ flags, shownError, restError }: RestingFrame): string {
  const error = `error ${significant(shownError)} as shown`;
  if (!(shownError > restError)) return error; // also if there is no such aim
  return flags & Flag.FINAL
    ? `${error}, ${significant(restError)} not reached`
    : `${error}, to be ${significant(restError)}`;
}

export function statusText({ framesPerSecond, frame, roundTripMs, viewers }: Status): string {
  const parts: string[] = [];
  if (frame) {
    const { flags, samples, simulateMs, renderMs, encodeMs } = frame;
    const atRest = samples > 1 && (flags & Flag.MOVING) === 0;
    if (flags & Flag.FINAL) parts.push("still picture");
    else parts.push(atRest ? "refining" : `${framesPerSecond.toFixed(1)} frames/s`);
    if (flags & Flag.SLOW) parts.push("slow motion");
    parts.push(
      atRest
        ? `render ${milliseconds(renderMs / samples)} ms a sample`
        : `server ${milliseconds(simulateMs + renderMs + encodeMs)} ms (simulate ${milliseconds(simulateMs)}, ` +
            `render ${milliseconds(renderMs)}, encode ${milliseconds(encodeMs)})`,
    );
  } else parts.push("waiting for the first picture");
  if (roundTripMs !== null) parts.push(`round trip ${milliseconds(roundTripMs)} ms`);
  if (frame) {
    if (!Number.isNaN(frame.shownError)) parts.push(shownErrorText(frame));
    else if (!Number.isNaN(frame.error)) parts.push(`${errorName(frame)} ${significant(frame.error)}`);
    if (frame.lightCut > 0 || frame.flags & Flag.SHADOWS_ONLY) parts.push(lightText(frame)); // NaN without a map
    parts.push(`${frame.width}\u00d7${frame.height}`, frame.samples === 1 ? "1 sample" : `${frame.samples} samples`);
  }
  parts.push(viewersText(viewers));
  return parts.join(" \u00b7 ");
}
