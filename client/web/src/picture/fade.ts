/** A better picture of what is seen already comes up within a moment: nothing pops when things come to rest. */

import { Flag, type Frame } from "@culet/protocol/frame";

/** Short enough that the finished picture is not waited for, long enough that no step is seen. */
export const FADE_MS = 150;

/** How much the new picture covers the old one so many ms after it began to come up: 0 to 1. */
export function coveredAfter(ms: number): number {
  return Math.min(1, Math.max(0, ms / FADE_MS));
}

/** Whether a frame is a better picture of the state that was shown last. */
export function refines({ step, flags }: Pick<Frame, "step" | "flags">, shown: bigint | null): boolean {
  return step === shown && !(flags & Flag.MOVING);
}
