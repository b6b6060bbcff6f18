/** Where the stones are when the picture shows none of them: what an empty room does not say. */

import { Flag, type Frame } from "@culet/protocol/frame";
import type { JsonObject } from "@culet/protocol/messages";
import { worded } from "./wording";

/** ms for which stones that move may be out of the picture before that is said: they often come back by themselves. */
export const GRACE_MS = 1000;

type Seen = Pick<Frame, "flags" | "simulationTime">;

const SIDES = [
  [Flag.BEHIND, "behind the camera"],
  [Flag.ABOVE, "above the picture"],
  [Flag.BELOW, "below the picture"],
  [Flag.LEFT, "to the left of the picture"],
  [Flag.RIGHT, "to the right of the picture"],
] as const;

/** Of several stones a frame tells where the nearest is. */
const WHO = { one: "The stone", several: "The nearest stone" };
const REMEDY = { one: "P lets it fall.", several: "P lets them fall." };
/** The button that has all stones looked at. */
export const LOOK = { one: "Look at it", several: "Look at them" };

/** What to say of the stones of a frame of that scene, or null if the picture may show one. */
export function whereaboutsText({ flags, simulationTime }: Seen, scene: JsonObject | null): string | null {
  const side = SIDES.find(([flag]) => flags & flag);
  if (!side) return null;
  const falls = side[0] === Flag.ABOVE && simulationTime === 0 && !(flags & Flag.MOVING);
  return `${worded(WHO, scene)} is ${side[1]}.${falls ? ` ${worded(REMEDY, scene)}` : ""}`;
}

/** Follows the frames of a session. */
export class Whereabouts {
  private seenAt = Number.NEGATIVE_INFINITY;

  /** What to say once this frame is shown, at a time in ms, or null. */
  after(frame: Seen, time: number, scene: JsonObject | null): string | null {
    const text = whereaboutsText(frame, scene);
    if (text === null) this.seenAt = time;
    return frame.flags & Flag.MOVING && time - this.seenAt < GRACE_MS ? null : text;
  }
}
