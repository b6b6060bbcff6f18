/** What the panel lets one choose, as a scene has it, and the merge patches that choose it. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Catalogued } from "./catalogue";
import { number, part, text } from "./json";
import { imageSky, skyPatch } from "./sky-choice";
import { stoneOf, stonePatch, stonesOf } from "./stones";

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
    summary: "Weak light is dropped. The picture says how much light was dropped: it is darker by that at most",
  },
  {
    name: "by chance",
    summary: "Weak light is dropped at random, and the light that goes on counts for more: right on average, but noisy",
  },
  {
    name: "in the sky",
    summary: "Weak light leaves the stone at once and meets the sky: the picture is not darker, but this is a guess",
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

/** mm, of a scene that says nothing: that of about a carat. */
const CARAT_MM = 3.25;

/** The radius in millimetres of a stone of scale 1. */
export function sizeOf(scene: JsonObject | null): number {
  return number(scene?.millimetres, CARAT_MM);
}

export function sizePatch(millimetres: number): JsonObject {
  return { millimetres };
}

/** Whether the picture depends on the size: a stone is of a material that absorbs by a spectrum of its own. */
export function sizeMatters(scene: JsonObject | null, coloured: ReadonlySet<string>): boolean {
  return stonesOf(scene).some(({ material }) => typeof material === "string" && coloured.has(material));
}
