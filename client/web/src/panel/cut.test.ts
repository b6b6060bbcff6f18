import { describe, expect, it } from "vitest";
import type { CutKind } from "../session/catalogue";
import { words } from "../words/words";
import { cutName, cutOf, cutPatch, proportionsOf, shapeName, shapePatch } from "./cut";

const KIND: CutKind = {
  name: "brilliant",
  title: "Round brilliant",
  summary: "",
  proportions: {
    name: { const: "brilliant", default: "brilliant", type: "string" },
    pavilion_degrees: { default: 40.75, type: "number", usual: [36, 48], description: "Its slope" },
    lower_half_percent: { default: 80, maximum: 100, minimum: 0, type: "number", usual: [50, 95] },
    crown_steps: { default: 3, type: "integer", usual: [1, 5] },
  },
};
const PROPORTIONS = proportionsOf(KIND);
const CUT = { name: "brilliant", pavilion_degrees: 44, lower_half_percent: 75 };
const STONE = { id: "ruby", material: "ruby", position: [0, 4, 0] };

describe("the sliders", () => {
  it("are those of the server's list that are numbers, in its order, with its words", () => {
    expect(PROPORTIONS.map(({ label }) => label)).toEqual(["Pavilion, \u00b0", "Lower half, %", "Crown steps"]);
    expect(PROPORTIONS[0]?.hint).toBe("Its slope");
  });

  it("reach as far as is usual, and go by whole numbers where only these are allowed", () => {
    expect(PROPORTIONS.map(({ least, most, step }) => [least, most, step])).toEqual([
      [36, 48, 0.05],
      [50, 95, 0.05],
      [1, 5, 1],
    ]);
  });
});

describe("the cut of a stone", () => {
  it("is what the scene says, and the server's for the rest", () => {
    const otherwise = { pavilion_degrees: 40.75, lower_half_percent: 80, crown_steps: 3 };
    expect(cutOf({ stones: [{ ...STONE, cut: "brilliant" }] }, PROPORTIONS)).toEqual(otherwise);
    const said = { pavilion_degrees: 44, lower_half_percent: 75, crown_steps: 3 };
    expect(cutOf({ stones: [{ ...STONE, cut: CUT }] }, PROPORTIONS)).toEqual(said);
  });

  it("has a name, by name or by proportions", () => {
    expect(cutName({ stones: [{ cut: "brilliant", mesh: null }] })).toBe("brilliant");
    expect(cutName({ stones: [{ cut: CUT }] })).toBe("brilliant");
  });

  it.each([null, { stones: [] }, { stones: [{ cut: "brilliant", mesh: "m1" }] }, { stones: [{ cut: 3 }] }])(
    "is none in %j",
    (scene) => expect(cutName(scene)).toBeNull(),
  );
});

describe("a proportion that is changed", () => {
  it("takes the angles of tiers away, and nothing else of how the stone is cut anew", () => {
    const stone = (recut: object | null) => ({ stones: [{ ...STONE, cut: CUT, recut }] });
    const cut = { name: "brilliant", pavilion_degrees: 41 };
    const change = (recut: object | null) => cutPatch(stone(recut), "pavilion_degrees", 41).stones;
    const usual = { crown_ratio: 1, pavilion_ratio: 1, girdle_percent: null, table_percent: null };
    expect(change(null)).toEqual({ ruby: { cut } });
    expect(change({ ...usual, angles: {} })).toEqual({ ruby: { cut } });
    expect(change({ ...usual, angles: { 3: 41 } })).toEqual({ ruby: { cut, recut: null } });
    expect(change({ ...usual, crown_ratio: 1.1, angles: { 3: 41 } })).toEqual({
      ruby: { cut, recut: { angles: { 3: null } } },
    });
  });
});

describe("the list of cuts", () => {
  it("shows the cut's name, a file's shape, or nothing without a stone", () => {
    expect(shapeName({ stones: [{ cut: { name: "oval" } }] })).toBe("oval");
    expect(shapeName({ stones: [{ cut: "oval", mesh: "m1" }] })).toBe(words.cut.own);
    expect(shapeName({ stones: [] })).toBe("");
  });

  it("gives the stone another cut, of the usual proportions, in place of a mesh", () => {
    const patch = shapePatch({ stones: [{ ...STONE, cut: CUT, mesh: "m1" }] }, "oval");
    expect(patch).toEqual({ stones: { ruby: { cut: "oval", mesh: null, recut: null } } });
  });
});

describe("a change of a proportion", () => {
  it("leaves the others, and the rest of the stone", () => {
    const patch = cutPatch({ stones: [{ ...STONE, cut: CUT }] }, "pavilion_degrees", 41);
    expect(patch).toEqual({ stones: { ruby: { cut: { name: "brilliant", pavilion_degrees: 41 } } } });
  });

  it("makes proportions of a name", () => {
    const patch = cutPatch({ stones: [{ ...STONE, cut: "brilliant" }] }, "pavilion_degrees", 41);
    expect(patch).toEqual({ stones: { ruby: { cut: { name: "brilliant", pavilion_degrees: 41 } } } });
  });
});
