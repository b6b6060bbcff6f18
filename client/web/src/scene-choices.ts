/** What the panel lets one choose, as a scene has it, and the merge patches that choose it. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object, part, text, triple } from "./json";
import type { Catalogued } from "./rest";
import { imageSky, skyPatch } from "./sky-choice";

export interface Choices {
  /** A material's name, or what to call one that the scene describes by its indices. */
  material: string;
  /** The kind of the environment, or, of an image, which one: see `imageSky`. */
  sky: string;
  bands: number;
  polarised: boolean;
  cutoff: number;
  end: string;
  toneMap: string;
}

/** Values to choose from; a scene may have others. */
export const BANDS = [3, 8, 16, 32];
export const CUTOFFS = [0.1, 0.03, 0.01, 0.003, 0.001, 0.0001];
export const ENDS = { "cut, counted": "cut", "by chance": "roulette", "in the sky": "sky" };
export const TONE_MAPS = {
  neutral: "neutral",
  sRGB: "srgb",
  filmic: "filmic",
  "the report's": "classic",
  none: "none",
};
/** What they mean, by their names. */
export const ENDS_SAID: Catalogued[] = [
  {
    name: "cut, counted",
    summary: "What such light would still bring is dropped, and its sum is said: at most so much is missing",
  },
  { name: "by chance", summary: "It is ended by lot, and what goes on counts for more: right on average, but noisy" },
  {
    name: "in the sky",
    summary: "It leaves the stone where it is and takes the sky's light from there: no darker, but a guess",
  },
];
export const TONE_MAPS_SAID: Catalogued[] = [
  {
    name: "neutral",
    summary: "As it is, but for what is brighter than 0.8: that approaches white without reaching it",
  },
  { name: "sRGB", summary: "What is brighter than white is white" },
  { name: "filmic", summary: "Highlights are rolled off, and keep their hues" },
  { name: "the report's", summary: "As the report draws it" },
  { name: "none", summary: "The radiance itself, without the screen's curve: too dark on a screen" },
];
export const SKIES = { "studio lamps": "studio", dark: "dark", light: "light", "half-lit": "half" };

/** The scene's before there is one. */
export const NOTHING_CHOSEN: Choices = {
  material: "",
  sky: "",
  bands: 3,
  polarised: false,
  cutoff: 0.01,
  end: "cut",
  toneMap: "srgb",
};

export function choicesOf(scene: JsonObject | null): Choices {
  const { material } = stoneOf(scene);
  const environment = part(scene, "environment");
  const optics = part(scene, "optics");
  const none = NOTHING_CHOSEN;
  const kind = text(environment.kind, none.sky);
  return {
    material: text(material, material === undefined ? none.material : "its own indices"),
    sky: kind === "image" ? imageSky(text(environment.image, "")) : kind,
    bands: number(optics.bands, none.bands),
    polarised: optics.polarised === true,
    cutoff: number(optics.cutoff, none.cutoff),
    end: text(optics.end, none.end),
    toneMap: text(part(scene, "film").tone_map, none.toneMap),
  };
}

/** The merge patch that makes one choice and leaves the rest of the scene. */
export function patchOf<K extends keyof Choices>(scene: JsonObject | null, name: K, value: Choices[K]): JsonObject {
  switch (name) {
    case "material":
      return stonePatch(scene, { material: value });
    case "sky":
      return skyPatch(scene, String(value));
    case "toneMap":
      return { film: { tone_map: value } };
    default:
      return { optics: { [name]: value } };
  }
}

/** The merge patch that changes something about the scene's stone; a list is replaced as a whole. */
export function stonePatch(scene: JsonObject | null, change: JsonObject): JsonObject {
  return { stones: [{ ...stoneOf(scene), ...change }] };
}

export function hasStone(scene: JsonObject | null): boolean {
  return Array.isArray(scene?.stones) && scene.stones.length > 0;
}

/** mm. That of about a carat, which the server takes for a coloured material in a scene without a size. */
const CARAT_MM = 3.25;

/** The girdle's radius in millimetres. */
export function sizeOf(scene: JsonObject | null): number {
  return number(stoneOf(scene).size_mm, CARAT_MM);
}

/**
 * Whether the picture depends on the stone's size: it has a coloured material, or an absorption per millimetre. One
 * without a size absorbs per radius, and giving it one would change what its numbers mean.
 */
export function sizeMatters(scene: JsonObject | null, coloured: ReadonlySet<string>): boolean {
  const { material, size_mm: size, absorption } = stoneOf(scene);
  const absorbs = triple(absorption)?.some((coefficient) => coefficient > 0) ?? false;
  if (absorbs) return typeof size === "number";
  return typeof material === "string" && coloured.has(material);
}

export function stoneOf(scene: JsonObject | null): JsonObject {
  const stones = scene?.stones;
  return object(Array.isArray(stones) ? stones[0] : undefined);
}
