/** What is said of a ray, step by step. */

import type { Part, Path, Step } from "../session/answers";
import { words } from "../words/words";

/** "72 % of this pixel comes from the lamp at the left", the brightest first; what shows nothing is left out. */
export function sentencesOf(path: Path): string[] {
  const told = path.parts.filter(({ share }) => Math.abs(share) >= 5e-4);
  const sentences = told.map((part) => words.ray.share(percent(part.share), metText(part)));
  return sentences.length > 0 ? sentences : [words.ray.dark];
}

export function metText({ meets, number, side }: Part): string {
  if (meets !== "lamp") return words.ray.met[meets];
  return words.ray.lamp(side ? words.ray.sides[side] : "", number === null ? "" : String(number));
}

/** What happens at a step, in a few words. */
export function happensText(step: Step, path: Path): string {
  const said = words.ray.happens;
  const facet = facetText(step, path);
  const kept = percent(step.passes[0]?.kept ?? 0);
  switch (step.kind) {
    case "enters":
      return said.enters(facet);
    case "meets":
      return isTotal(step) ? said.total(facet) : said.leaves(facet, kept);
    case "lands":
      return step.passes[0]?.kept ? said.mirrored(kept) : said.lands;
    case "sees":
      return said.sees(originText(step));
    case "ends":
      return step.inside ? said.endsInside : said.ends;
    case "chance":
      return said.chance;
    default:
      return step.kind satisfies never;
  }
}

/** What the light of a step comes from: of several the brightest. */
function originText({ parts = [] }: Step): string {
  const [brightest] = [...parts].sort((a, b) => b.share - a.share);
  return brightest ? metText(brightest) : words.ray.happens.outside;
}

function facetText({ stone, facet, facet_name: name }: Step, { poses }: Path): string {
  const alone = Object.keys(poses).length < 2;
  const called = name ?? words.ray.unnamed(String(facet));
  return alone ? called : words.ray.facet(stone ?? "", called);
}

function isTotal(step: Step): boolean {
  return step.passes.every(({ refraction_degrees: beyond }) => beyond === null || beyond === undefined);
}

/** Whose light it is: letters of the channels, or wavelengths. */
export function lightText(step: Step, path: Path): string {
  const numbers = step.passes.map(({ chain }) => chain);
  if (numbers.includes(null)) return words.ray.allLight;
  const chains = numbers.map((number) => path.chains[number ?? 0]);
  const letters = chains.map((chain) => (chain?.channel ? words.ray.channels[chain.channel] : null));
  if (!letters.includes(null)) return letters.join("");
  const lengths = chains.map((chain) => chain?.wavelength ?? 0);
  const span = [Math.min(...lengths), Math.max(...lengths)].map((length) => length.toFixed(0));
  return span[0] === span[1] ? `${span[0]} nm` : `${span[0]}\u2013${span[1]} nm`;
}

/** A fact about a step: what it is called, and its value. */
export type Fact = readonly [name: string, value: string];

/** All facts of a step but what the table's columns have. */
export function factsOf(step: Step, path: Path, millimetres: number): Fact[] {
  const said = words.ray.facts;
  const first = step.passes[0];
  if (!first) return [];
  const numbers = (of: (pass: Step["passes"][number]) => number | null | undefined) => step.passes.map(of);
  const facts: (Fact | null)[] = [
    [said.light, lightText(step, path)],
    fact(
      said.incidence,
      span(
        numbers((pass) => pass.incidence_degrees),
        2,
      ),
      "\u00b0",
    ),
    fact(
      said.critical,
      span(
        numbers((pass) => pass.critical_degrees),
        2,
      ),
      "\u00b0",
    ),
    fact(
      said.refraction,
      span(
        numbers((pass) => pass.refraction_degrees),
        2,
      ),
      "\u00b0",
    ),
    first.reflectance
      ? [
          said.reflectance,
          said.polarised(
            percent(first.reflectance.s),
            percent(first.reflectance.p),
            percent(first.reflectance.unpolarised),
          ),
        ]
      : null,
    fact(
      said.length,
      span(
        numbers((pass) => (pass.length ?? Number.NaN) * millimetres),
        2,
      ),
      " mm",
    ),
    [said.before, percent(first.weight_before)],
    first.weight === first.weight_before ? null : [said.arrives, percent(first.weight)],
    first.reflectance || first.kept > 0 ? [said.kept, percent(first.weight * first.kept)] : null,
    first.reflectance ? [said.passes, percent(first.weight * (1 - first.kept))] : null,
    first.polarisation === null || first.polarisation === undefined
      ? null
      : [said.polarisation, percent(first.polarisation)],
    step.elevation_degrees === null || step.elevation_degrees === undefined
      ? null
      : [said.elevation, `${step.elevation_degrees.toFixed(1)}\u00b0`],
    first.cut > 0 ? [said.cut, percent(step.passes.reduce((sum, pass) => sum + pass.cut, 0))] : null,
    ...(step.parts ?? []).map((part): Fact => [metText(part), words.ray.ofPixel(percent(part.share))]),
  ];
  return facts.filter((each) => each !== null);
}

function fact(name: string, value: string, end: string): Fact | null {
  return value === "" ? null : [name, value + end];
}

/** What of the pixel comes by a step; empty where nothing does. */
export function shareText({ parts = [] }: Step): string {
  const share = parts.reduce((sum, part) => sum + part.share, 0);
  return parts.length > 0 ? percent(share) : "";
}

export function angleText(step: Step): string {
  const angle = span(
    step.passes.map((pass) => pass.incidence_degrees),
    1,
  );
  return angle === "" ? "" : `${angle}\u00b0`;
}

export function percent(share: number): string {
  const value = 100 * share;
  const size = Math.abs(value);
  const digits = size >= 9.95 || size === 0 ? 0 : size >= 0.095 ? 1 : 2;
  return `${value.toFixed(digits)}\u00a0%`;
}

/** One number, or the least and the largest where they differ. */
export function span(values: readonly (number | null | undefined)[], digits: number): string {
  const known = values.filter((value): value is number => typeof value === "number" && Number.isFinite(value));
  if (known.length === 0) return "";
  const [low, high] = [Math.min(...known).toFixed(digits), Math.max(...known).toFixed(digits)];
  return low === high ? low : `${low}\u2013${high}`;
}
