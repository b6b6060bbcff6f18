import { describe, expect, it } from "vitest";
import { asItCame, asItCamePatch, recutOf, recutPatch, uploadOf } from "./recut";

const OWN = { girdle_percent: 3, table_percent: 53 };
const SCENE = { stones: [{ id: "a", mesh: "m1", recut: { crown_ratio: 1.1, table_percent: 60 } }] };

describe("a design that is cut anew", () => {
  it("is as the scene says, and else as its file has it", () => {
    expect(recutOf(SCENE, OWN)).toEqual({ crown_ratio: 1.1, pavilion_ratio: 1, girdle_percent: 3, table_percent: 60 });
    expect(recutOf({ stones: [{ id: "a", mesh: "m1", recut: null }] }, null).girdle_percent).toBeNaN();
  });

  it("keeps what else was changed when one slider is moved", () => {
    expect(recutPatch(SCENE, "pavilion_ratio", 0.9)).toEqual({ stones: { a: { recut: { pavilion_ratio: 0.9 } } } });
  });

  it("is as it came again", () => {
    expect(asItCamePatch(SCENE)).toEqual({ stones: { a: { recut: null } } });
    expect(asItCame(SCENE)).toEqual({ stones: [{ id: "a", mesh: "m1", recut: null }] });
  });

  it("is a file's alone", () => {
    expect(uploadOf(SCENE)).toBe("m1");
    expect(uploadOf({ stones: [{ id: "a", cut: "oval", mesh: null }] })).toBe("");
  });
});
