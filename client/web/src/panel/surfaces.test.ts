import { describe, expect, it, test } from "vitest";
import { object } from "../json";
import {
  BARE,
  causticsPatch,
  hexOf,
  isMatte,
  linearOf,
  type Surface,
  showsCaustics,
  surfaceOf,
  surfacePatch,
  throwsCaustics,
} from "./surfaces";

const SCENE = {
  floor: { kind: "matte", albedo: [0.5, 0.25, 0], checker: { albedo: [1, 0.1, 0.02], cell: 2 } },
  walls: { kind: "mirror", albedo: [0.9, 0.9, 0.9], checker: "off" },
  optics: { caustics: "off", bands: 8 },
};
const FLOOR: Surface = { albedo: "#bc8900", checkered: true, cell: 2, other: "#ff5927" };

describe("a colour", () => {
  it("is the sRGB code of the light that comes back", () => {
    expect(hexOf([0, 1, 0.2159])).toBe("#00ff80");
    expect(linearOf("#00ff80")).toEqual([0, 1, 0.2159]);
  });

  it("comes back whatever its code is", () => {
    for (let code = 0; code < 256; code += 1) {
      const hex = `#${code.toString(16).padStart(2, "0").repeat(3)}`;
      expect(hexOf(linearOf(hex))).toBe(hex);
    }
  });

  it("is never beyond what a screen shows", () => {
    expect(hexOf([-1, 2, 1])).toBe("#00ffff");
  });
});

describe("a surface of a scene", () => {
  it("is what the scene says", () => {
    expect(surfaceOf(SCENE, "floor")).toEqual(FLOOR);
    expect(surfaceOf(SCENE, "walls")).toEqual({ ...BARE, checkered: false });
  });

  it.each([null, {}, { floor: 3 }, { floor: { albedo: "red", checker: null } }, { floor: { checker: "off" } }])(
    "survives %j",
    (scene) => {
      expect(surfaceOf(scene, "floor")).toEqual(BARE);
      expect(isMatte(scene, "floor")).toBe(false);
    },
  );
});

describe("a change", () => {
  test.each(Object.entries({ ...FLOOR, cell: 3 }) as [keyof Surface, never][])(
    "of %s reaches the scene",
    (name, value) => {
      const patch = surfacePatch("floor", name, value, FLOOR);
      expect(surfaceOf(patch, "floor")[name]).toEqual(value);
      expect(Object.keys(patch)).toEqual(["floor"]);
      expect(Object.keys(object(patch.floor))).toHaveLength(1);
    },
  );

  it("of a checker that comes back brings its cells back", () => {
    expect(surfacePatch("walls", "checkered", false)).toEqual({ walls: { checker: "off" } });
    expect(surfaceOf(surfacePatch("walls", "checkered", true, FLOOR), "walls")).toEqual({
      ...FLOOR,
      albedo: BARE.albedo,
    });
  });

  it("of the cells leaves the rest of the checker", () => {
    expect(surfacePatch("floor", "cell", 0.5)).toEqual({ floor: { checker: { cell: 0.5 } } });
  });
});

describe("caustics", () => {
  it("are on unless the scene says otherwise", () => {
    expect(throwsCaustics(null)).toBe(true);
    expect(throwsCaustics(SCENE)).toBe(false);
    expect(throwsCaustics(causticsPatch(true))).toBe(true);
    expect(throwsCaustics(causticsPatch(false))).toBe(false);
  });

  it("are seen on matte surfaces and on the studio's floor alone", () => {
    const kinds = (floor: string, walls: string) => showsCaustics({ floor: { kind: floor }, walls: { kind: walls } });
    expect(kinds("matte", "none")).toBe(true);
    expect(kinds("mirror", "matte")).toBe(true);
    expect(kinds("studio", "none")).toBe(true);
    expect(kinds("mirror", "mirror")).toBe(false);
    expect(kinds("none", "none")).toBe(false);
    expect(showsCaustics({ ...SCENE, optics: { estimator: "classic" } })).toBe(false);
  });
});
