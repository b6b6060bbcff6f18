/** The status line's words. */

import { Codec, Flag, type Frame } from "@culet/protocol/frame";
import { words } from "../words/words";
import type { Bottleneck } from "./bottleneck";

/** Frames a second that are told as 0.1, at least. */
const LEAST_RATE = 0.05;

export interface Status {
  /** Pictures come, or would if anything changed. */
  connected: boolean;
  framesPerSecond: number;
  frame: Omit<Frame, "payload"> | null;
  roundTripMs: number | null;
  viewers: number;
  bottleneck?: Bottleneck | null;
}

/** At most three significant digits before it gets noisy: 0.12, 1.75, 31.5, 2049. */
export function milliseconds(value: number): string {
  return value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toFixed(2);
}

/** Two significant digits, without an exponent as long as a reader can count the zeros. */
export function significant(value: number): string {
  return value === 0 || value >= 1e-4 ? String(Number(value.toPrecision(2))) : value.toExponential(1);
}

type RestingFrame = Pick<Frame, "flags" | "shownError" | "restError">;

/** A moving picture's error is not its own: it is what the measured front says of its settings. */
function errorName({ flags }: Pick<Frame, "flags">): string {
  return flags & Flag.FRONTIER ? words.status.frontiersError : words.status.error;
}

/** Of the light that stones throw on floor and walls at most this part is missing. */
function lightText({ flags, lightCut }: Pick<Frame, "flags" | "lightCut">): string {
  if (flags & Flag.SHADOWS_ONLY) return words.status.shadowsOnly;
  return words.status.lightCut(significant(100 * lightCut));
}

/** How good a picture at rest is, and, if that is another thing, how good it was to be. */
function shownErrorText({ flags, shownError, restError }: RestingFrame): string {
  const error = words.status.shownError(significant(shownError));
  if (!(shownError > restError)) return error; // also if there is no such aim
  return flags & Flag.FINAL
    ? words.status.notReached(error, significant(restError))
    : words.status.toBe(error, significant(restError));
}

/** Pictures of one sample come while the camera moves, too, and the first one at rest is one: after it none comes at once. */
function isMoving({ flags, samples }: Pick<Frame, "flags" | "samples">, framesPerSecond: number): boolean {
  return (flags & Flag.MOVING) !== 0 || (samples === 1 && framesPerSecond >= LEAST_RATE);
}

/** What everybody wants to know: whether the picture is finished, or how fast it moves; and who else looks. */
export function briefText({ connected, framesPerSecond, frame, viewers }: Status): string {
  const said = words.status;
  if (!connected) return said.offline;
  if (!frame) return said.waiting;
  const moves = isMoving(frame, framesPerSecond);
  const parts = [moves ? said.framesPerSecond(framesPerSecond) : said.refining];
  if (frame.flags & Flag.FINAL) parts[0] = said.still;
  if (frame.flags & Flag.SLOW) parts.push(said.slowMotion);
  if (viewers > 1) parts.push(said.viewers(viewers));
  return parts.join(" \u00b7 ");
}

function codecName({ codec }: Pick<Frame, "codec">): string {
  const name = Object.keys(Codec).find((key): key is keyof typeof Codec => Codec[key as keyof typeof Codec] === codec);
  return name ? words.status.codecs[name] : "";
}

export function statusText({ connected, framesPerSecond, frame, roundTripMs, viewers, bottleneck }: Status): string {
  const said = words.status;
  if (!connected) return said.offline;
  const parts: string[] = [];
  if (frame) {
    const { flags, samples, simulateMs, renderMs, encodeMs } = frame;
    const atRest = !isMoving(frame, framesPerSecond);
    if (flags & Flag.FINAL) parts.push(said.still);
    else parts.push(atRest ? said.refining : said.framesPerSecond(framesPerSecond));
    if (bottleneck) parts.push(said.limitedBy[bottleneck]);
    if (flags & Flag.SLOW) parts.push(said.slowMotion);
    parts.push(
      atRest
        ? said.perSample(milliseconds(renderMs / samples))
        : said.server(
            milliseconds(simulateMs + renderMs + encodeMs),
            milliseconds(simulateMs),
            milliseconds(renderMs),
            milliseconds(encodeMs),
          ),
    );
  } else parts.push(said.waiting);
  if (roundTripMs !== null) parts.push(said.roundTrip(milliseconds(roundTripMs)));
  if (frame) {
    if (!Number.isNaN(frame.shownError)) parts.push(shownErrorText(frame));
    else if (!Number.isNaN(frame.error)) parts.push(said.errorIs(errorName(frame), significant(frame.error)));
    if (frame.lightCut > 0 || frame.flags & Flag.SHADOWS_ONLY) parts.push(lightText(frame)); // NaN without a map
    parts.push(`${said.size(frame.width, frame.height)} ${codecName(frame)}`, said.samples(frame.samples));
  }
  parts.push(said.viewers(viewers));
  return parts.join(" \u00b7 ");
}
