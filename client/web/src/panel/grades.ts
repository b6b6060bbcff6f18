/** A stone's grades, as the server tells them. */

import type { JsonObject } from "@culet/protocol/messages";
import { list, number, object, part, text } from "../json";
import { stoneOf } from "../stones/stones";
import { words } from "../words/words";

/** A line of the table: what, how much, its standard error, and what all that means. */
export interface GradeLine {
  name: string;
  value: string;
  error: string;
  /** To that of a design that is compared; null without one. */
  difference: string | null;
  hint: string;
}

/** Points of a curve: degrees, and ISO brightness about each axis. */
export type TiltColumns = [number[], number[], number[]];

export interface GradeTable {
  /** "9.10 x 6.50 x 4.02 mm, 1.53 ct" */
  size: string;
  lines: GradeLine[];
  tilt: TiltColumns | null;
}

/** Degrees. */
const TOLD_TILTS = [-30, 0, 30];

type GradeName = keyof typeof words.grades.lines;

const SHARES: readonly GradeName[] = ["leak", "red", "green", "blue"];
const OWN: readonly GradeName[] = ["iso", "cos", "sc2", "contrast", "fire", "window", "extinction"];

/** What the answer of a request for grades says, and how far it is from that for another design. */
export function reportOf(answer: JsonObject, other: JsonObject | null = null): GradeTable {
  const grades = part(answer, "grades");
  const shares = part(grades, "shares");
  const others = part(other, "grades");
  const otherShares = part(others, "shares");
  const than = (said: unknown) => (other ? object(said) : null);
  const lines = [
    ...OWN.map((name) => line(name, object(grades[name]), than(others[name]), 1)),
    ...SHARES.map((name) => line(name, object(shares[name]), than(otherShares[name]), 1)),
  ];
  const { weighted_light_return: light } = answer;
  if (light) lines.push(line("weightedLightReturn", object(light), than(other?.weighted_light_return), 3));
  return { size: sizeOf(part(answer, "size")), lines, tilt: tiltOf(part(answer, "tilt")) };
}

function line(name: GradeName, said: JsonObject, other: JsonObject | null, decimals: number): GradeLine {
  const [label, meaning] = words.grades.lines[name];
  const value = number(said.value, Number.NaN).toFixed(decimals);
  const error = number(said.error, Number.NaN).toFixed(decimals + 1);
  const bound = number(said.bound, 0).toFixed(decimals + 1);
  return {
    name: label,
    value: decimals === 1 ? `${value} %` : value,
    error: `\u00b1 ${error}`,
    difference: other && signed(number(said.value, Number.NaN) - number(other.value, Number.NaN), decimals),
    hint: words.grades.sure(meaning, error, bound),
  };
}

function signed(value: number, decimals: number): string {
  return Number.isFinite(value) ? `${value < 0 ? "\u2212" : "+"}${Math.abs(value).toFixed(decimals)}` : "";
}

function sizeOf(size: JsonObject): string {
  const [length, width, depth] = [size.length, size.width, size.depth].map((side) => number(side, 0).toFixed(2));
  return words.grades.size(
    `${length} \u00d7 ${width} \u00d7 ${depth}`,
    String(Number(number(size.carats, 0).toPrecision(3))),
  );
}

function tiltOf(tilt: JsonObject): TiltColumns | null {
  const [x, z] = [list(tilt.x), list(tilt.z)];
  if (x.length === 0 || x.length !== z.length) return null;
  const iso = (points: JsonObject[]) => points.map((point) => number(part(point, "iso").value, 0));
  return [x.map(({ degrees }) => number(degrees, 0)), iso(x), iso(z)];
}

/** What the curves say, for those who cannot see them: ISO at no tilt, and at the ends of a viewer's usual tilts. */
export function tiltText([degrees, ...curves]: TiltColumns): string {
  const said = curves.map((curve, axis) => {
    const points = TOLD_TILTS.map((told) => {
      const at = degrees.indexOf(told);
      return at < 0 ? null : words.grades.tiltPoint(told, (curve[at] ?? Number.NaN).toFixed(1));
    });
    return words.grades.tiltCurve(words.grades.axes[axis] ?? "", points.filter((point) => point !== null).join(", "));
  });
  return said.join(" ");
}

/** What of the scene grades depend on: the same text means the same grades. */
export function gradedBy(scene: JsonObject | null): string {
  const { id, cut, mesh, recut, material, scale, density, mass } = stoneOf(scene);
  return id === undefined
    ? ""
    : JSON.stringify([text(id, ""), cut, mesh, recut ?? null, material, scale, density, mass, scene?.millimetres]);
}
