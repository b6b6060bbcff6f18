/** A better picture of what is seen already comes up within a moment: nothing pops when things come to rest. */

import { Flag, type Frame } from "@culet/protocol/frame";

/** Short enough that the finished picture is not waited for, long enough that no step is seen. */
export const FADE_MS = 150;

/** How much the new picture covers the old one so many ms after it began to come up: 0 to 1. */
export function coveredAfter(ms: number): number {
  return Math.min(1, Math.max(0, ms / FADE_MS));
}

/** What of a frame tells how good it is. */
export type Judged = Pick<Frame, "step" | "flags" | "width" | "height" | "shownError">;

/** Pixels by which the sides of two pictures of the same shape differ: sizes are rounded. */
const ROUNDING = 2;

/**
 * Whether a picture is of the same state as the one that is shown, and worse to look at: one of more pixels has begun
 * anew, and may come with fewer over a link that does not carry them all. Seen from where the other's pixels cannot be
 * told apart, its noise is less by as much as its pixels are smaller.
 */
export function isWorse(frame: Judged, shown: Judged | null): boolean {
  if (!shown || frame.step !== shown.step || (frame.flags | shown.flags) & Flag.MOVING) return false;
  const error = Number.isNaN(frame.shownError) ? Number.POSITIVE_INFINITY : frame.shownError; // of a first sample
  const reduced = isReduced(frame) && (shown.flags & Flag.FINAL) !== 0 && isAlike(frame, shown);
  return (frame.width > shown.width || reduced) && error * shown.width > shown.shownError * frame.width;
}

/** For the sake of its link. */
function isReduced({ flags }: Judged): boolean {
  return (flags & Flag.THRIFTY) !== 0;
}

/** Whether both have the same shape, but for what rounding does to it. */
function isAlike(a: Judged, b: Judged): boolean {
  const smaller = Math.min(a.width, b.width);
  return Math.abs(a.height / a.width - b.height / b.width) * smaller <= ROUNDING;
}

/** Whether a frame is a better picture of the state that was shown last. */
export function refines({ step, flags }: Pick<Frame, "step" | "flags">, shown: bigint | null): boolean {
  return step === shown && !(flags & Flag.MOVING);
}
