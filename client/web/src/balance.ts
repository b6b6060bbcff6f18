/** The balance between speed and exactness, in words and numbers. */

import { Flag, type Frame } from "@culet/protocol/frame";
import { EXACTEST_RATE, FASTEST_RATE } from "@culet/protocol/messages";

export interface BalanceShown {
  exactness: number;
  pinned: boolean;
}

/** Frames per second that moving frames are held to; null if the quality is pinned instead. */
export function askedRate({ exactness, pinned }: BalanceShown): number | null {
  return pinned ? null : FASTEST_RATE * (EXACTEST_RATE / FASTEST_RATE) ** exactness;
}

export function balanceText(balance: BalanceShown): string {
  const rate = askedRate(balance);
  if (rate !== null) return `In motion: ${rate.toFixed(0)} frames/s, as good as time allows.`;
  if (balance.exactness === 1) return "In motion: all that the scene asks for, however long it takes.";
  return `In motion: quality held at ${Math.round(balance.exactness * 100)} %, however long it takes.`;
}

/** What a frame was drawn with. */
export function settingsText(frame: Omit<Frame, "payload">): string {
  const { width, height, samples, bands, cutoff, maxBounces, flags } = frame;
  return [
    `${width}\u00d7${height}`,
    samples === 1 ? "1 sample" : `${samples} samples`,
    `${bands} bands`,
    `cut-off ${Number(cutoff.toPrecision(3))}`,
    `${maxBounces} bounces`,
    flags & Flag.POLARISED ? "polarised" : "unpolarised",
  ].join(" \u00b7 ");
}
