/** How the design of a file is cut anew, as a scene says it, and the merge patches that change that. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, text } from "../json";
import type { Proportions } from "../session/answers";
import { stoneOf, stonePatch } from "../stones/stones";

/** Ratios by which crown and pavilion are steeper; girdle and table, per cent of the width. */
export interface Recut {
  crown_ratio: number;
  pavilion_ratio: number;
  girdle_percent: number;
  table_percent: number;
}

/** Of the file itself. */
export type Own = Pick<Proportions, "girdle_percent" | "table_percent">;

/** The upload that the stone's shape comes from; empty for a cut. */
export function uploadOf(scene: JsonObject | null): string {
  return text(stoneOf(scene).mesh, "");
}

/** What the scene says, and of what it does not say how the file has it; NaN of what is not known. */
export function recutOf(scene: JsonObject | null, own: Own | null): Recut {
  const said = part(stoneOf(scene), "recut");
  return {
    crown_ratio: number(said.crown_ratio, 1),
    pavilion_ratio: number(said.pavilion_ratio, 1),
    girdle_percent: number(said.girdle_percent, own?.girdle_percent ?? Number.NaN),
    table_percent: number(said.table_percent, own?.table_percent ?? Number.NaN),
  };
}

/** The merge patch that changes one of them and leaves the others. */
export function recutPatch(scene: JsonObject | null, name: keyof Recut, value: number): JsonObject {
  return stonePatch(scene, { recut: { [name]: value } });
}

/** The merge patch that leaves the stone as its file has it. */
export function asItCamePatch(scene: JsonObject | null): JsonObject {
  return stonePatch(scene, { recut: null });
}

/** The scene's stone as its file has it, alone. */
export function asItCame(scene: JsonObject | null): JsonObject {
  return { stones: [{ ...stoneOf(scene), recut: null }] };
}
