/** The proportions of a stone's cut, as the server lists and a scene says them, and the merge patches that change them. */

import type { JsonObject } from "@culet/protocol/messages";
import type { CutKind } from "./catalogue";
import { number, object, part, text } from "./json";
import { stoneOf, stonePatch } from "./stones";

/** A slider about one proportion. */
export interface Proportion {
  name: string;
  label: string;
  least: number;
  most: number;
  otherwise: number;
  hint: string;
}

interface Usual {
  range: readonly [number, number];
  hint: string;
}

/** What is cut: of all that the server allows, a slider this short could not tell a degree from the next. */
const USUAL: Record<string, Usual> = {
  table_percent: { range: [45, 75], hint: "The top facet's width, % of the girdle's diameter" },
  crown_degrees: { range: [20, 45], hint: "Slope of the main facets above the girdle" },
  pavilion_degrees: {
    range: [36, 48],
    hint: "Slope of the main facets below the girdle: too flat or too steep, and light leaks through them",
  },
  star_percent: { range: [30, 70], hint: "How far the stars reach from the table, % of the way to the girdle" },
  lower_half_percent: { range: [50, 95], hint: "How far the lower halves reach down, % of the way to the culet" },
  girdle_percent: { range: [0.5, 10], hint: "Thickness at the main facets, % of the diameter" },
};

const UNITS: Record<string, string> = { percent: ", %", degrees: ", \u00b0" };
const NO_LIMIT: readonly [number, number] = [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY];

/** The sliders for a cut; each within what the server allows and what is usual. */
export function proportionsOf({ proportions }: CutKind): Proportion[] {
  return Object.entries(proportions).flatMap(([name, value]) => {
    const schema = object(value);
    if (schema.type !== "number") return [];
    const [least, most] = USUAL[name]?.range ?? NO_LIMIT;
    return {
      name,
      label: labelOf(name),
      least: Math.max(least, number(schema.minimum ?? schema.exclusiveMinimum, least)),
      most: Math.min(most, number(schema.maximum ?? schema.exclusiveMaximum, most)),
      otherwise: number(schema.default, 0),
      hint: USUAL[name]?.hint ?? "",
    };
  });
}

/** "Lower half, %" of `lower_half_percent`. */
function labelOf(name: string): string {
  const words = name.split("_");
  const unit = UNITS[words.at(-1) ?? ""] ?? "";
  const said = (unit ? words.slice(0, -1) : words).join(" ");
  return said.charAt(0).toUpperCase() + said.slice(1) + unit;
}

/** The name of the stone's cut, or null if it has none: there is no stone, or a mesh takes the cut's place. */
export function cutName(scene: JsonObject | null): string | null {
  const { cut, mesh } = stoneOf(scene);
  return typeof mesh === "string" ? null : text(cut, text(object(cut).name, "")) || null;
}

/** The proportions that the stone has, by their names. */
export function cutOf(scene: JsonObject | null, proportions: readonly Proportion[]): Record<string, number> {
  const cut = part(stoneOf(scene), "cut");
  return Object.fromEntries(proportions.map(({ name, otherwise }) => [name, number(cut[name], otherwise)]));
}

/** The merge patch that changes one proportion and leaves the others. */
export function cutPatch(scene: JsonObject | null, name: string, value: number): JsonObject {
  return stonePatch(scene, { cut: { name: cutName(scene), [name]: value } });
}
