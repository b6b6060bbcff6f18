/** Where the stone is when the picture does not show it: what an empty room does not say. */

import { Flag, type Frame } from "@culet/protocol/frame";

/** ms for which a stone that moves may be out of the picture before that is said: it often comes back by itself. */
export const GRACE_MS = 1000;

type Seen = Pick<Frame, "flags" | "simulationTime">;

const SIDES = [
  [Flag.BEHIND, "behind the camera"],
  [Flag.ABOVE, "above the picture"],
  [Flag.BELOW, "below the picture"],
  [Flag.LEFT, "to the left of the picture"],
  [Flag.RIGHT, "to the right of the picture"],
] as const;

/** What to say of the stone in a frame, or null if the picture may show it. */
export function whereaboutsText({ flags, simulationTime }: Seen): string | null {
  const side = SIDES.find(([flag]) => flags & flag);
  if (!side) return null;
  const falls = side[0] === Flag.ABOVE && simulationTime === 0 && !(flags & Flag.MOVING);
  return `The stone is ${side[1]}.${falls ? " P lets it fall." : ""}`;
}

/** Follows the frames of a session. */
export class Whereabouts {
  private seenAt = Number.NEGATIVE_INFINITY;

  /** What to say once this frame is shown, at a time in ms, or null. */
  after(frame: Seen, time: number): string | null {
    const text = whereaboutsText(frame);
    if (text === null) this.seenAt = time;
    return frame.flags & Flag.MOVING && time - this.seenAt < GRACE_MS ? null : text;
  }
}
