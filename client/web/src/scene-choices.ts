/** What the panel lets one choose, as a scene has it, and the merge patches that choose it. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Material } from "./catalogue";
import type { Option } from "./controls/choice";
import { number, part, text } from "./json";
import { imageSky, skyPatch } from "./sky-choice";
import { stoneOf, stonePatch, stonesOf } from "./stones";

export interface Choices {
  /** A material's name; OWN_INDICES of one that the scene describes by its indices. */
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
export const ENDS: readonly Option<string>[] = [
  {
    label: "cut, counted",
    value: "cut",
    summary: "Weak light is dropped. The picture says how much light was dropped: it is darker by that at most",
  },
  {
    label: "by chance",
    value: "roulette",
    summary: "Weak light is dropped at random, and the light that goes on counts for more: right on average, but noisy",
  },
  {
    label: "in the sky",
    value: "sky",
    summary: "Weak light leaves the stone at once and meets the sky: the picture is not darker, but this is a guess",
  },
];
export const TONE_MAPS: readonly Option<string>[] = [
  {
    label: "neutral",
    value: "neutral",
    summary: "As it is, but for what is brighter than 0.8: that approaches white without reaching it",
  },
  { label: "sRGB", value: "srgb", summary: "What is brighter than white is white" },
  { label: "filmic", value: "filmic", summary: "Highlights are rolled off, and keep their hues" },
  { label: "the report's", value: "classic", summary: "As the report draws it" },
  { label: "none", value: "none", summary: "The radiance itself, without the screen's curve: too dark on a screen" },
];
export const SKIES: readonly Option<string>[] = [
  { label: "studio lamps", value: "studio", summary: "The scene's own lamps and soft boxes" },
  { label: "dark", value: "dark", summary: "The report's night: lamps alone are bright" },
  { label: "light", value: "light", summary: "The report's day: bright all around" },
  { label: "half-lit", value: "half", summary: "Bright on one side, dark on the other" },
];

/** A material that the scene describes by its indices: shown, and not to be chosen. No name has spaces. */
export const OWN_INDICES: Option<string> = { label: "its own indices", value: "its own indices" };

/** A material under the name that people use, with what its index does: beyond the critical angle all light stays inside. */
export function materialOption({ name, title, summary, indices }: Material): Option<string> {
  const index = indices[1];
  const critical = (Math.asin(1 / index) * 180) / Math.PI;
  const said = `${summary}\nIndex ${index.toFixed(2)} for green; critical angle ${critical.toFixed(1)}\u00b0`;
  return { label: title, value: name, summary: said };
}

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
    material: text(material, material === undefined ? none.material : OWN_INDICES.value),
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
