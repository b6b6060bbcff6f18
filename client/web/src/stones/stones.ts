/** The stones of a scene by their ids, and the merge patches that change one of them. */

import type { JsonObject } from "@culet/protocol/messages";
import { list, text } from "../json";

/** That a scene may have. */
export const MOST_STONES = 64;

/** What a stone is called that is made where there is none. */
const FIRST = "stone";

export function stonesOf(scene: JsonObject | null): JsonObject[] {
  return list(scene?.stones);
}

/** The stone of that id; the first one if none is named; empty if there is no such stone. */
export function stoneOf(scene: JsonObject | null, id?: string): JsonObject {
  const stones = stonesOf(scene);
  return (id === undefined ? stones[0] : stones.find((stone) => stone.id === id)) ?? {};
}

export function idsOf(scene: JsonObject | null): string[] {
  return stonesOf(scene).map(({ id }) => text(id, ""));
}

/** The scene with that stone first: the one that the panel shows and changes. Without one it is as it was. */
export function withFirst(scene: JsonObject | null, id: string | null): JsonObject | null {
  const first = stonesOf(scene).find((stone) => stone.id === id);
  return first ? { ...scene, stones: [first, ...stonesOf(scene).filter((stone) => stone !== first)] } : scene;
}

export function hasStone(scene: JsonObject | null): boolean {
  return stonesOf(scene).length > 0;
}

/** The merge patch that changes something about one stone, the first if none is named, and leaves all others. */
export function stonePatch(scene: JsonObject | null, change: JsonObject, id?: string): JsonObject {
  const shape = hasStone(scene) ? {} : { cut: "brilliant" };
  return { stones: { [id ?? text(stoneOf(scene).id, FIRST)]: { ...shape, ...change } } };
}
