/** The proportions of a stone's cut, as the server lists and a scene says them, and the merge patches that change them. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object, part, text } from "../json";
import type { CutKind } from "../session/catalogue";
import { hasStone, stoneOf, stonePatch } from "../stones/stones";
import { words } from "../words/words";
import { anglesOf, recutWithout } from "./tiers";

/** A slider about one proportion. */
export interface Proportion {
  name: string;
  label: string;
  least: number;
  most: number;
  step: number;
  otherwise: number;
  hint: string;
}

/** Of a slider about a proportion that is no whole number. */
const STEP = 0.05;

const UNITS = ["percent", "degrees"] as const;

/** The sliders for a cut. Each is as long as is usual: of all that the server allows, it could not tell a degree from the next. */
export function proportionsOf({ proportions }: CutKind): Proportion[] {
  return Object.entries(proportions).flatMap(([name, value]) => {
    const schema = object(value);
    if (schema.type !== "number" && schema.type !== "integer") return [];
    const otherwise = number(schema.default, 0);
    const [least, most]: unknown[] = Array.isArray(schema.usual) ? schema.usual : [];
    return {
      name,
      label: labelOf(name),
      least: number(least, otherwise),
      most: number(most, otherwise),
      step: schema.type === "integer" ? 1 : STEP,
      otherwise,
      hint: text(schema.description, ""),
    };
  });
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
  const turned = Object.keys(anglesOf(scene));
  return stonePatch(scene, {
    cut: { name: cutName(scene), [name]: value },
    ...(turned.length > 0 ? { recut: recutWithout(scene, turned) } : {}), // or the angles of tiers would stay where the cut's are changed
  });
}

/** What the list of cuts shows: the cut's name, or that a file has the shape; nothing without a stone. */
export function shapeName(scene: JsonObject | null): string {
  return cutName(scene) ?? (hasStone(scene) ? words.cut.own : "");
}

/** The merge patch that gives the stone another cut, of the usual proportions. */
export function shapePatch(scene: JsonObject | null, name: string): JsonObject {
  return stonePatch(scene, { cut: name, mesh: null, recut: null });
}
