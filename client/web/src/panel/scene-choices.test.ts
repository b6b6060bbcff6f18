import { describe, expect, it, test } from "vitest";
import { object } from "../json";
import {
  BANDS,
  type Choices,
  choicesOf,
  ENDS,
  indicesOf,
  materialFacts,
  materialOption,
  NOTHING_CHOSEN,
  OWN_INDICES,
  patchOf,
  SKIES,
  sizeMatters,
  sizeOf,
  sizePatch,
  TONE_MAPS,
} from "./scene-choices";
import { imageSky } from "./sky-choice";

const INDICES = [1.95, 2, 2.05] as const;
const STONE = { id: "stone", cut: "brilliant", material: "ruby", position: [0, 4, 0] };
const SCENE = {
  stones: [STONE],
  environment: { kind: "image", image: "light-box", scale: 2 },
  optics: { bands: 16, polarised: true, cutoff: 0.003, end: "roulette", max_bounces: 64 },
  film: { tone_map: "filmic", exposure: 2, fireflies: "hide" },
};
const CHOSEN: Choices = {
  material: "ruby",
  sky: "image:light-box",
  bands: 16,
  polarised: true,
  cutoff: 0.003,
  end: "roulette",
  toneMap: "filmic",
  hideFireflies: true,
};

describe("the choices of a scene", () => {
  it("are what it says", () => {
    expect(choicesOf(SCENE)).toEqual(CHOSEN);
    expect(choicesOf({ environment: { kind: "studio" } }).sky).toBe("studio");
  });

  it("leave the number of wavelengths to the server, which moves fewer", () => {
    expect(choicesOf({ optics: { bands: "auto" } }).bands).toBe("auto");
    expect(choicesOf({ optics: { bands: "many" } }).bands).toBe(3);
    expect(patchOf(SCENE, "bands", "auto")).toEqual({ optics: { bands: "auto" } });
    expect(BANDS[0]?.value).toBe("auto");
  });

  it("call a material by indices what it is", () => {
    expect(choicesOf({ stones: [{ material: { ior: [1.7, 1.8, 1.9] } }] }).material).toBe(OWN_INDICES.value);
  });

  it.each([null, {}, { stones: [], optics: null, film: 3, environment: "dark" }])("survive %j", (scene) => {
    expect(choicesOf(scene)).toEqual(NOTHING_CHOSEN);
  });
});

describe("a choice", () => {
  test.each(Object.entries(CHOSEN) as [keyof Choices, never][])("of %s patches nothing else", (name, value) => {
    const patch = patchOf({ stones: [{ ...STONE, material: "diamond" }] }, name, value);
    const after = { ...NOTHING_CHOSEN, [name]: value };
    const scene = { ...patch, stones: Object.values(object(patch.stones)) };
    expect(choicesOf(scene)).toEqual(after);
    expect(Object.keys(patch)).toHaveLength(1);
  });

  it("of a material leaves the stone's shape and place", () => {
    expect(patchOf(SCENE, "material", "emerald")).toEqual({ stones: { stone: { material: "emerald" } } });
  });

  it("of a sky is one of its kind, or an image", () => {
    expect(patchOf(SCENE, "sky", "light")).toEqual({ environment: { kind: "light" } });
    expect(patchOf(SCENE, "sky", imageSky("a1"))).toEqual({ environment: { kind: "image", image: "a1" } });
  });
});

describe("the size", () => {
  const coloured = new Set(["ruby"]);

  it("is the scene's, or that of a carat", () => {
    expect(sizeOf({ stones: [] })).toBe(3.25);
    expect(sizeOf({ millimetres: 5 })).toBe(5);
    expect(sizePatch(5)).toEqual({ millimetres: 5 });
  });

  it("matters if any stone is of a coloured material", () => {
    const clear = { material: "diamond", absorption: [0, 1, 0] };
    expect(sizeMatters({ stones: [clear, { material: "ruby" }] }, coloured)).toBe(true);
    expect(sizeMatters({ stones: [clear, { material: { ior: [2, 2, 2] } }] }, coloured)).toBe(false);
    expect(sizeMatters({ stones: [] }, coloured)).toBe(false);
  });
});

it("explains each sky, end and tone map", () => {
  for (const { label, value, summary } of [...SKIES, ...ENDS, ...TONE_MAPS]) {
    expect([label, value, summary].every(Boolean)).toBe(true);
  }
});

it("calls a material what people call it", () => {
  const diamond = { name: "diamond", title: "Diamond", summary: "The usual.", coloured: false, indices: INDICES };
  expect(materialOption(diamond)).toEqual({ label: "Diamond", value: "diamond", summary: "The usual." });
});

it("tells what the indices of a material do to light", () => {
  const facts = materialFacts(INDICES);
  expect(facts).toContain("index 2.000"); // of green
  expect(facts).toContain("dispersion 0.100"); // of blue over red
  expect(facts).toContain("critical angle 30.0\u00b0"); // the sine of which is 1 over 2
  expect(facts).toContain("Brewster's 63.4\u00b0"); // the tangent of which is 2
});

it("knows the indices of a stone by its material's name, or as the scene says them", () => {
  const materials = [{ name: "ruby", title: "Ruby", summary: "", coloured: true, indices: INDICES }];
  expect(indicesOf(SCENE, materials)).toBe(INDICES);
  expect(indicesOf(SCENE, [])).toBeNull();
  expect(indicesOf({ stones: [{ material: { ior: [1.5, 1.6, 1.7] } }] }, [])).toEqual([1.5, 1.6, 1.7]);
  expect(indicesOf({ stones: [] }, materials)).toBeNull();
  // BK7's by Schott: 1.5143, 1.5187 and 1.5267 at the lines C, e and g.
  const pairs = [
    [1.03961212, Math.sqrt(0.00600069867)],
    [0.231792344, Math.sqrt(0.0200179144)],
    [1.01046945, Math.sqrt(103.560653)],
  ];
  const glass = indicesOf({ stones: [{ material: { sellmeier: pairs } }] }, []) ?? [0, 0, 0];
  for (const [k, known] of [1.5143, 1.5187, 1.5267].entries()) expect(glass[k]).toBeCloseTo(known, 4);
  expect(indicesOf({ stones: [{ material: { sellmeier: [[-2, 0.1]] } }] }, [])).toBeNull();
});
