/** What changed in a scene, applied: see "parts of a change" in the protocol's specification. */

import type { JsonObject } from "@culet/protocol/messages";
import { stonesOf } from "../stones/stones";

const STONE = "stones.";

/** The scene with these parts; what did not change is the same object as before. */
export function withParts(scene: JsonObject, parts: JsonObject): JsonObject {
  const named = Object.entries(parts);
  const after = { ...scene, ...Object.fromEntries(named.filter(([name]) => !name.startsWith(STONE))) };
  const ofStones = named.filter(([name]) => name.startsWith(STONE));
  if (ofStones.length === 0) return after;
  const stones = new Map<unknown, unknown>(stonesOf(after).map((stone) => [stone.id, stone]));
  for (const [name, stone] of ofStones) {
    if (stone === null) stones.delete(name.slice(STONE.length));
    else stones.set(name.slice(STONE.length), stone);
  }
  return { ...after, stones: [...stones.values()] };
}
