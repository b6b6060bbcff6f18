/** Floor and walls as a scene says them, the light on them, and the merge patches that change both. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object, part, text, triple } from "../json";

/** The scene's names of both. */
export type SurfaceName = "floor" | "walls";

export const PLACES: readonly SurfaceName[] = ["floor", "walls"];

export interface Surface {
  /** Its colour, as a screen shows it: `#rrggbb`. */
  albedo: string;
  checkered: boolean;
  /** Side of a cell, R. */
  cell: number;
  /** Colour of every other cell. */
  other: string;
}

/** The scene's before there is one, and what a checker that a scene leaves open is. */
export const BARE: Surface = {
  albedo: hexOf([0.9, 0.9, 0.9]),
  checkered: false,
  cell: 1,
  other: hexOf([0.6, 0.6, 0.6]),
};

export type Rgb = readonly [number, number, number];

/** sRGB's transfer function (IEC 61966-2-1) and 8 bits of each channel. */
export function hexOf(linear: Rgb): string {
  const encoded = linear.map((part) => {
    const within = Math.min(Math.max(part, 0), 1);
    const shown = within <= 0.0031308 ? 12.92 * within : 1.055 * within ** (1 / 2.4) - 0.055;
    return Math.round(255 * shown)
      .toString(16)
      .padStart(2, "0");
  });
  return `#${encoded.join("")}`;
}

/** Its inverse, with four decimals: a step of 8 bits is 0.0003 where it is smallest. */
export function linearOf(hex: string): Rgb {
  const channel = (from: number) => {
    const shown = Number.parseInt(hex.slice(from, from + 2), 16) / 255;
    const linear = shown <= 0.04045 ? shown / 12.92 : ((shown + 0.055) / 1.055) ** 2.4;
    return Number(linear.toFixed(4));
  };
  return [channel(1), channel(3), channel(5)];
}

function colourOf(albedo: unknown, otherwise: string): string {
  const linear = triple(albedo);
  return linear ? hexOf(linear) : otherwise;
}

export function surfaceOf(scene: JsonObject | null, place: SurfaceName): Surface {
  const { albedo, checker } = part(scene, place);
  const { cell, albedo: other } = object(checker);
  return {
    albedo: colourOf(albedo, BARE.albedo),
    checkered: typeof checker === "object" && checker !== null,
    cell: number(cell, BARE.cell),
    other: colourOf(other, BARE.other),
  };
}

/** Whether it is matte: a mirror, a studio's floor and one that is not there have no use for an albedo. */
export function isMatte(scene: JsonObject | null, place: SurfaceName): boolean {
  return text(part(scene, place).kind, "none") === "matte";
}

/** The merge patch that changes one property; `before` is the checker that comes back when it is turned on. */
export function surfacePatch<K extends keyof Surface>(
  place: SurfaceName,
  name: K,
  value: Surface[K],
  before: Pick<Surface, "cell" | "other"> = BARE,
): JsonObject {
  switch (name) {
    case "albedo":
      return { [place]: { albedo: linearOf(String(value)) } };
    case "checkered":
      return { [place]: { checker: value ? { albedo: linearOf(before.other), cell: before.cell } : "off" } };
    case "cell":
      return { [place]: { checker: { cell: value } } };
    default:
      return { [place]: { checker: { albedo: linearOf(String(value)) } } };
  }
}

/** Whether stones throw caustics, and not their shadows alone. */
export function throwsCaustics(scene: JsonObject | null): boolean {
  return text(part(scene, "optics").caustics, "on") === "on";
}

export function causticsPatch(on: boolean): JsonObject {
  return { optics: { caustics: on ? "on" : "off" } };
}

/** Whether anything in the scene can show caustics: matte surfaces do, and the studio's floor; no mirror, and not the report's shading. */
export function showsCaustics(scene: JsonObject | null): boolean {
  if (text(part(scene, "optics").estimator, "chain") === "classic") return false;
  return text(part(scene, "floor").kind, "none") === "studio" || PLACES.some((place) => isMatte(scene, place));
}
