/** The balance between speed and exactness, in words and numbers. */

import { Flag, type Frame } from "@culet/protocol/frame";
import { EXACTEST_RATE, FASTEST_RATE } from "@culet/protocol/messages";
import { words } from "../words/words";

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
  if (rate !== null) return words.meter.byRate(rate);
  if (balance.exactness === 1) return words.meter.exact;
  return words.meter.byQuality(balance.exactness);
}

/** What a frame was drawn with. */
export function settingsText(frame: Omit<Frame, "payload">): string {
  const { width, height, samples, bands, cutoff, maxBounces, flags } = frame;
  return [
    words.status.size(width, height),
    words.status.samples(samples),
    words.meter.bands(bands),
    words.meter.cutoff(String(Number(cutoff.toPrecision(3)))),
    words.meter.bounces(maxBounces),
    flags & Flag.POLARISED ? words.meter.polarised : words.meter.unpolarised,
  ].join(" \u00b7 ");
}
