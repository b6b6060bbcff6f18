import { describe, expect, it } from "vitest";
import { hasStone, idsOf, stoneOf, stonePatch, stonesOf, withFirst } from "./stones";

const RUBY = { id: "ruby", cut: "brilliant", material: "ruby" };
const GLASS = { id: "glass", cut: "brilliant", material: { ior: [1.5, 1.5, 1.5] } };
const SCENE = { stones: [RUBY, GLASS] };

describe("a stone", () => {
  it("is found by its id, or is the first", () => {
    expect(stoneOf(SCENE)).toBe(RUBY);
    expect(stoneOf(SCENE, "glass")).toBe(GLASS);
    expect(stoneOf(SCENE, "gone")).toEqual({});
    expect([hasStone(SCENE), hasStone({ stones: [] }), hasStone(null)]).toEqual([true, false, false]);
  });

  it("is changed by its id alone, so that the others stay", () => {
    expect(stonePatch(SCENE, { material: "quartz" })).toEqual({ stones: { ruby: { material: "quartz" } } });
    expect(stonePatch(SCENE, { scale: 2 }, "glass")).toEqual({ stones: { glass: { scale: 2 } } });
  });

  it("is made where there was none", () => {
    expect(stonePatch({ stones: [] }, { mesh: "m1" })).toEqual({ stones: { stone: { cut: "brilliant", mesh: "m1" } } });
    expect(stonePatch(null, { mesh: "m1" })).toEqual({ stones: { stone: { cut: "brilliant", mesh: "m1" } } });
  });
});

describe("the chosen stone", () => {
  it("is the first for the panel, and so the one that is changed", () => {
    const seen = withFirst(SCENE, "glass");
    expect(idsOf(seen)).toEqual(["glass", "ruby"]);
    expect(stonePatch(seen, { scale: 2 })).toEqual({ stones: { glass: { scale: 2 } } });
    expect(idsOf(SCENE)).toEqual(["ruby", "glass"]);
  });

  it.each([null, "gone"])("%s changes nothing", (id) => {
    expect(withFirst(SCENE, id)).toBe(SCENE);
  });
});

it.each([null, {}, { stones: null }, { stones: {} }])("there are no stones in %j", (scene) => {
  expect(stonesOf(scene)).toEqual([]);
});
