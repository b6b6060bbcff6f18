/** What the panel lets one choose, as a scene has it, and the merge patches that choose it. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Option } from "../controls/choice";
import { number, object, part, text, triple } from "../json";
import type { MaterialChoice } from "../session/catalogue";
import { stoneOf, stonePatch, stonesOf } from "../stones/stones";
import { words } from "../words/words";
import { imageSky, skyPatch } from "./sky-choice";

/** A number of wavelengths; or more of them by themselves while the picture rests. */
export type Bands = number | "auto";

export interface Choices {
  /** A material's name; OWN_INDICES of one that the scene describes by its indices. */
  material: string;
  /** The kind of the environment, or, of an image, which one: see `imageSky`. */
  sky: string;
  bands: Bands;
  polarised: boolean;
  cutoff: number;
  end: string;
  toneMap: string;
  /** Whether the screen leaves out what a single sample has made bright. */
  hideFireflies: boolean;
}

/** One index for each of red, green and blue. */
const INDICES = 3;
/** Values to choose from; a scene may have others. */
export const BANDS: readonly Option<Bands>[] = [
  { label: words.optics.autoBands, value: "auto", summary: words.optics.autoBandsHint },
  ...[INDICES, 8, 16, 32].map((value) => ({ label: String(value), value })),
];
export const CUTOFFS = [0.1, 0.03, 0.01, 0.003, 0.001, 0.0001];
export const ENDS = optionsOf(words.ends, ["cut", "roulette", "sky"]);
export const TONE_MAPS = optionsOf(words.toneMaps, ["neutral", "srgb", "filmic", "classic", "none"]);
export const SKIES = optionsOf(words.skies, ["studio", "dark", "light", "half"]);

/** Options by the scene's names for them, with the page's words for each: what it is called, and what it means. */
function optionsOf<K extends string>(
  said: Record<K, readonly [string, string]>,
  names: readonly K[],
): Option<string>[] {
  return names.map((value) => ({ label: said[value][0], value, summary: said[value][1] }));
}

/** A material that the scene describes by its indices: shown, and not to be chosen. No name has brackets. */
export const OWN_INDICES: Option<string> = { label: words.material.own, value: "(indices)" };

/** A material under the name that people use. */
export function materialOption({ name, title, summary }: MaterialChoice): Option<string> {
  return { label: title, value: name, summary };
}

/** What the indices of a material for red, green and blue do to light, in degrees for green. */
export function materialFacts([red, green, blue]: MaterialChoice["indices"]): string {
  const critical = (Math.asin(1 / green) * 180) / Math.PI;
  const brewster = (Math.atan(green) * 180) / Math.PI;
  return words.material.facts(green, critical, brewster, blue - red);
}

/** The indices of the stone's material, by its name or as the scene says them; null if they are not known. */
export function indicesOf(
  scene: JsonObject | null,
  materials: readonly MaterialChoice[],
): MaterialChoice["indices"] | null {
  const { material } = stoneOf(scene);
  if (typeof material === "string") return materials.find(({ name }) => name === material)?.indices ?? null;
  const { ior, sellmeier } = object(material);
  return triple(ior) ?? (Array.isArray(sellmeier) ? sellmeierIndices(sellmeier) : null);
}

/** Micrometres of the lines that stand for red, green and blue, as the server's wavelengths.py has them. */
const LINES = [0.6563, 0.5461, 0.4358] as const;

/** n^2 = 1 + sum B l^2 / (l^2 - C^2) (Sellmeier 1871); null where that is no index. */
function sellmeierIndices(pairs: readonly unknown[]): MaterialChoice["indices"] | null {
  const known = pairs.filter((pair): pair is [number, number] => Array.isArray(pair) && pair.length === 2);
  const index = (line: number) => {
    return Math.sqrt(known.reduce((sum, [b, c]) => sum + (b * line * line) / (line * line - c * c), 1));
  };
  const indices = LINES.map(index);
  return indices.every((each) => each >= 1) ? triple(indices) : null;
}

/** The scene's before there is one. */
export const NOTHING_CHOSEN: Choices = {
  material: "",
  sky: "",
  bands: INDICES,
  polarised: false,
  cutoff: 0.01,
  end: "cut",
  toneMap: "srgb",
  hideFireflies: false,
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
    bands: optics.bands === "auto" ? "auto" : number(optics.bands, INDICES),
    polarised: optics.polarised === true,
    cutoff: number(optics.cutoff, none.cutoff),
    end: text(optics.end, none.end),
    toneMap: text(part(scene, "film").tone_map, none.toneMap),
    hideFireflies: part(scene, "film").fireflies === "hide",
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
    case "hideFireflies":
      return { film: { fireflies: value ? "hide" : "keep" } };
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
