/** Where the stones are when the picture shows none of them: what an empty room does not say. */

import { Flag, type Frame } from "@culet/protocol/frame";
import type { JsonObject } from "@culet/protocol/messages";
import { worded } from "../words/wording";
import { words } from "../words/words";

/** ms for which stones that move may be out of the picture before that is said: they often come back by themselves. */
export const GRACE_MS = 1000;

type Seen = Pick<Frame, "flags" | "simulationTime">;

const SIDES = [
  [Flag.BEHIND, words.whereabouts.behind],
  [Flag.ABOVE, words.whereabouts.above],
  [Flag.BELOW, words.whereabouts.below],
  [Flag.LEFT, words.whereabouts.left],
  [Flag.RIGHT, words.whereabouts.right],
] as const;

/** What to say of the stones of a frame of that scene, or null if the picture may show one. */
export function whereaboutsText({ flags, simulationTime }: Seen, scene: JsonObject | null): string | null {
  const side = SIDES.find(([flag]) => flags & flag);
  if (!side) return null;
  const falls = side[0] === Flag.ABOVE && simulationTime === 0 && !(flags & Flag.MOVING);
  const { who, is, remedy } = words.whereabouts;
  const said = is(worded(who, scene), side[1]); // of several stones a frame tells where the nearest is
  return falls ? `${said} ${worded(remedy, scene)}` : said;
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
