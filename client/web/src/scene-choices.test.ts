import { describe, expect, it, test } from "vitest";
import {
  type Choices,
  choicesOf,
  ENDS,
  ENDS_SAID,
  NOTHING_CHOSEN,
  patchOf,
  sizeMatters,
  sizeOf,
  stonePatch,
  TONE_MAPS,
  TONE_MAPS_SAID,
} from "./scene-choices";
import { imageSky } from "./sky-choice";

const STONE = { cut: "brilliant", material: "ruby", position: [0, 4, 0] };
const SCENE = {
  stones: [STONE],
  environment: { kind: "image", image: "light-box", scale: 2 },
  optics: { bands: 16, polarised: true, cutoff: 0.003, end: "roulette", max_bounces: 64 },
  film: { tone_map: "filmic", exposure: 2 },
};
const CHOSEN: Choices = {
  material: "ruby",
  sky: "image:light-box",
  bands: 16,
  polarised: true,
  cutoff: 0.003,
  end: "roulette",
  toneMap: "filmic",
};

describe("the choices of a scene", () => {
  it("are what it says", () => {
    expect(choicesOf(SCENE)).toEqual(CHOSEN);
    expect(choicesOf({ environment: { kind: "studio", lamps: [] } }).sky).toBe("studio");
  });

  it("call a material by indices what it is", () => {
    expect(choicesOf({ stones: [{ material: { ior: [1.7, 1.8, 1.9] } }] }).material).toBe("its own indices");
  });

  it.each([null, {}, { stones: [], optics: null, film: 3, environment: "dark" }])("survive %j", (scene) => {
    expect(choicesOf(scene)).toEqual(NOTHING_CHOSEN);
  });
});

describe("a choice", () => {
  test.each(Object.entries(CHOSEN) as [keyof Choices, never][])("of %s patches nothing else", (name, value) => {
    const patch = patchOf({ stones: [{ ...STONE, material: "diamond" }] }, name, value);
    const after = { ...NOTHING_CHOSEN, [name]: value };
    expect({ ...choicesOf(patch), material: name === "material" ? value : "" }).toEqual(after);
    expect(Object.keys(patch)).toHaveLength(1);
  });

  it("of a material leaves the stone's shape and place", () => {
    expect(patchOf(SCENE, "material", "emerald")).toEqual({ stones: [{ ...STONE, material: "emerald" }] });
  });

  it("of a sky is one of its kind, or an image", () => {
    expect(patchOf(SCENE, "sky", "light")).toEqual({ environment: { kind: "light" } });
    expect(patchOf(SCENE, "sky", imageSky("a1"))).toEqual({ environment: { kind: "image", image: "a1" } });
  });
});

it("changes the stone, or makes one where there was none", () => {
  expect(stonePatch(SCENE, { mesh: "m1" })).toEqual({ stones: [{ ...STONE, mesh: "m1" }] });
  expect(stonePatch({ stones: [] }, { mesh: "m1" })).toEqual({ stones: [{ mesh: "m1" }] });
  expect(stonePatch(null, { mesh: "m1" })).toEqual({ stones: [{ mesh: "m1" }] });
});

describe("the size", () => {
  const coloured = new Set(["ruby"]);
  const matters = (stone: Record<string, unknown>) => sizeMatters({ stones: [stone] }, coloured);

  it("is that of a carat unless the scene has one", () => {
    expect(sizeOf({ stones: [{ size_mm: null }] })).toBe(3.25);
    expect(sizeOf({ stones: [{ size_mm: 5 }] })).toBe(5);
  });

  it("matters to a coloured material, and to an absorption per millimetre", () => {
    expect(matters({ material: "ruby", size_mm: null, absorption: [0, 0, 0] })).toBe(true);
    expect(matters({ material: "diamond", size_mm: 2, absorption: [0, 1, 0] })).toBe(true);
  });

  it("does not to clear ones, and would change what an absorption per radius means", () => {
    expect(matters({ material: "diamond", size_mm: 2, absorption: [0, 0, 0] })).toBe(false);
    expect(matters({ material: "ruby", size_mm: null, absorption: [0, 1, 0] })).toBe(false);
    expect(sizeMatters({ stones: [] }, coloured)).toBe(false);
  });
});

it("explains each end and each tone map by the name that the list has", () => {
  expect(ENDS_SAID.map(({ name }) => name)).toEqual(Object.keys(ENDS));
  expect(TONE_MAPS_SAID.map(({ name }) => name)).toEqual(Object.keys(TONE_MAPS));
});
