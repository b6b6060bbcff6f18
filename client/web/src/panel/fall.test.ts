import { describe, expect, it, test } from "vitest";
import { object } from "../json";
import { type Fall, fallOf, fallPatch, NOTHING_FALLS, spinAxis } from "./fall";

const STONE = { id: "ruby", cut: "brilliant", position: [1, 4, 2], spin: [0, 3, 4] };
const SIMULATION = {
  gravity: 1.6,
  restitution: 0.5,
  friction: 0.1,
  rolling_resistance: 0.03,
  model: "classic",
  integrator: "euler",
  seed: 7,
};
const SCENE = { stones: [STONE], simulation: SIMULATION, floor: { kind: "matte" } };
const FALL: Fall = {
  height: 4,
  spin: 5,
  gravity: 1.6,
  restitution: 0.5,
  friction: 0.1,
  rolling: 0.03,
  model: "classic",
  integrator: "euler",
};

describe("how a scene's stone falls", () => {
  it("is what it says", () => {
    expect(fallOf(SCENE)).toEqual(FALL);
  });

  it.each([null, {}, { stones: [{ position: "up", spin: [1, 2] }], simulation: { gravity: "low" } }])(
    "survives %j",
    (scene) => {
      expect(fallOf(scene)).toEqual(NOTHING_FALLS);
      expect(spinAxis(scene)).toBeNull();
    },
  );
});

describe("a change", () => {
  test.each(Object.entries(FALL) as [keyof Fall, never][])("of %s patches nothing else", (name, value) => {
    const before = { stones: [{ ...STONE, position: [1, 0, 2], spin: [0, 0.3, 0.4] }] };
    const patch = fallPatch(before, name, value);
    const after = { ...patch, stones: Object.values(object(patch.stones)) };
    expect(fallOf(after)[name]).toEqual(value);
    expect(Object.keys(patch)).toEqual([["height", "spin"].includes(name) ? "stones" : "simulation"]);
    expect({ ...fallOf(after), [name]: NOTHING_FALLS[name] }).toEqual(NOTHING_FALLS);
  });

  it("of the height leaves the rest of the stone", () => {
    expect(fallPatch(SCENE, "height", 2)).toEqual({ stones: { ruby: { position: [1, 2, 2] } } });
  });

  it("of the spin keeps its axis, or takes the one that it had", () => {
    expect(fallPatch(SCENE, "spin", 10)).toEqual({ stones: { ruby: { spin: [0, 6, 8] } } });
    const still = { stones: [{ ...STONE, spin: [0, 0, 0] }] };
    expect(spinAxis(still)).toBeNull();
    expect(fallPatch(still, "spin", 2)).toEqual({ stones: { ruby: { spin: [0, 2, 0] } } });
    expect(fallPatch(still, "spin", 2, [1, 0, 0])).toEqual({ stones: { ruby: { spin: [2, 0, 0] } } });
  });
});
