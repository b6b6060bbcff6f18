import { describe, expect, it } from "vitest";
import type { CutKind } from "../session/catalogue";
import { cutName, cutOf, cutPatch, proportionsOf } from "./cut";

const KIND: CutKind = {
  name: "brilliant",
  proportions: {
    name: { const: "brilliant", default: "brilliant", type: "string" },
    pavilion_degrees: { default: 40.75, exclusiveMaximum: 42, exclusiveMinimum: 0, type: "number" },
    lower_half_percent: { default: 80, maximum: 50, minimum: 3, type: "number" },
    culet_percent: { default: 1, maximum: 5, minimum: 0, type: "number" },
  },
};
const PROPORTIONS = proportionsOf(KIND);
const CUT = { name: "brilliant", pavilion_degrees: 44, lower_half_percent: 75 };
const STONE = { id: "ruby", material: "ruby", position: [0, 4, 0] };

describe("the sliders", () => {
  it("are those of the server's list that are numbers, in its order", () => {
    expect(PROPORTIONS.map(({ label }) => label)).toEqual(["Pavilion, \u00b0", "Lower half, %", "Culet, %"]);
  });

  it("reach as far as is usual, but not beyond what the server allows; one that is new, as far as that", () => {
    expect(PROPORTIONS.map(({ least, most }) => [least, most])).toEqual([
      [36, 42],
      [50, 50],
      [0, 5],
    ]);
  });
});

describe("the cut of a stone", () => {
  it("is what the scene says, and the server's for the rest", () => {
    const otherwise = { pavilion_degrees: 40.75, lower_half_percent: 80, culet_percent: 1 };
    expect(cutOf({ stones: [{ ...STONE, cut: "brilliant" }] }, PROPORTIONS)).toEqual(otherwise);
    const said = { pavilion_degrees: 44, lower_half_percent: 75, culet_percent: 1 };
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
