/** The proportions of a stone's cut, as the server lists and a scene says them, and the merge patches that change them. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object, part, text } from "../json";
import type { CutKind } from "../session/catalogue";
import { stoneOf, stonePatch } from "../stones/stones";
import { type Words, words } from "../words/words";

/** A slider about one proportion. */
export interface Proportion {
  name: string;
  label: string;
  least: number;
  most: number;
  otherwise: number;
  hint: string;
}

type Usual = keyof Words["cut"]["hints"];

/** What is cut: of all that the server allows, a slider this short could not tell a degree from the next. */
const USUAL: Record<Usual, readonly [number, number]> = {
  table_percent: [45, 75],
  crown_degrees: [20, 45],
  pavilion_degrees: [36, 48],
  star_percent: [30, 70],
  lower_half_percent: [50, 95],
  girdle_percent: [0.5, 10],
};

const UNITS = ["percent", "degrees"] as const;
const NO_LIMIT: readonly [number, number] = [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY];

/** The sliders for a cut; each within what the server allows and what is usual. */
export function proportionsOf({ proportions }: CutKind): Proportion[] {
  return Object.entries(proportions).flatMap(([name, value]) => {
    const schema = object(value);
    if (schema.type !== "number") return [];
    const [least, most] = isUsual(name) ? USUAL[name] : NO_LIMIT;
    return {
      name,
      label: labelOf(name),
      least: Math.max(least, number(schema.minimum ?? schema.exclusiveMinimum, least)),
      most: Math.min(most, number(schema.maximum ?? schema.exclusiveMaximum, most)),
      otherwise: number(schema.default, 0),
      hint: isUsual(name) ? words.cut.hints[name] : "",
    };
  });
}

function isUsual(name: string): name is Usual {
  return name in USUAL;
}

/** "Lower half, %" of `lower_half_percent`. */
function labelOf(name: string): string {
  const parts = name.split("_");
  const unit = UNITS.find((known) => known === parts.at(-1)) ?? null;
  return words.cut.proportion((unit ? parts.slice(0, -1) : parts).join(" "), unit);
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
