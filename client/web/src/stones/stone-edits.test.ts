import type { JsonObject } from "@culet/protocol/messages";
import { describe, expect, it } from "vitest";
import { object } from "../json";
import { additionOf, anotherLike, freeId, removalOf, scatterPatch } from "./stone-edits";

const RUBY = { id: "ruby", cut: "brilliant", material: "ruby", scale: 0.5, position: [1, -0.7, 0] };
const GLASS = { id: "glass", cut: "brilliant", scale: 2, position: [-3, 1, 0] };
const SCENE = { stones: [RUBY, GLASS] };

function distance(a: JsonObject, b: JsonObject): number {
  const [from, to] = [a.position as number[], b.position as number[]];
  return Math.hypot(...from.map((x, axis) => x - (to[axis] ?? 0)));
}

it.each([
  ["ruby", [], "ruby"],
  ["ruby", ["ruby"], "ruby-2"],
  ["ruby-2", ["ruby", "ruby-2"], "ruby-3"],
  ["a".repeat(32), ["a".repeat(32)], `${"a".repeat(30)}-2`],
])("%s, where there are %j, is called %s", (like, taken, id) => {
  expect(freeId(like, taken)).toBe(id);
});

describe("another stone like one", () => {
  it("is as that is, beside it at its height, and reaches into no other", () => {
    let scene: JsonObject = SCENE;
    for (let count = 2; count < 12; count++) {
      const { id, patch } = anotherLike(scene, "ruby");
      const added = object(object(patch.stones)[id]);
      expect(added).toMatchObject({ id: `ruby-${count}`, material: "ruby", scale: 0.5 });
      expect((added.position as number[])[1]).toBe(-0.7);
      for (const other of scene.stones as JsonObject[]) {
        expect(distance(added, other)).toBeGreaterThan(0.5 + Number(other.scale));
      }
      scene = { stones: [...(scene.stones as JsonObject[]), added] };
    }
  });
});

it("a stone that was removed comes back as it was, by another id if that is taken now", () => {
  expect(removalOf("ruby")).toEqual({ stones: { ruby: null } });
  expect(additionOf({ stones: [GLASS] }, RUBY)).toEqual({ id: "ruby", patch: { stones: { ruby: RUBY } } });
  const again = { stones: { "ruby-2": { ...RUBY, id: "ruby-2" } } };
  expect(additionOf(SCENE, RUBY)).toEqual({ id: "ruby-2", patch: again });
});

describe("scattered stones", () => {
  const stones = Array.from({ length: 64 }, (_, k) => ({ id: `stone-${k}`, scale: 0.4 + (k % 5) / 4 }));
  const camera = { target: [3, 0, -4] };
  const scattered = object(scatterPatch({ stones, camera, walls: { kind: "matte" } }).stones);

  it("are all there, in the air between the walls, and apart", () => {
    const placed = stones.map(({ id, scale }) => ({ scale, position: object(scattered[id]).position as number[] }));
    for (const [k, one] of placed.entries()) {
      const [x, , z] = one.position as [number, number, number];
      for (const wall of [z, z / 2 + x * Math.sqrt(0.75), z / 2 - x * Math.sqrt(0.75)]) {
        expect(wall).toBeGreaterThan(one.scale - 8);
      }
      expect(Math.hypot(x - 3, z + 4)).toBeLessThan(40);
      expect(one.position[1]).toBeGreaterThan(-1 + one.scale);
      for (const other of placed.slice(k + 1)) expect(distance(one, other)).toBeGreaterThan(one.scale + other.scale);
    }
  });

  it("find a place however large they are", () => {
    const large = Array.from({ length: 24 }, (_, k) => ({ id: `large-${k}`, scale: 100 }));
    const placed = Object.values(object(scatterPatch({ stones: large }).stones)).map(object);
    for (const [k, one] of placed.entries()) {
      for (const other of placed.slice(k + 1)) expect(distance(one, other)).toBeGreaterThan(200);
    }
  });

  it("are turned by rotations, no two alike", () => {
    const turns = stones.map(({ id }) => object(scattered[id]).orientation as number[]);
    for (const turn of turns) expect(Math.hypot(...turn)).toBeCloseTo(1, 12);
    expect(new Set(turns.map(String)).size).toBe(64);
  });

  it("keep the rest of what they are", () => {
    expect(Object.keys(object(scattered["stone-0"]))).toEqual(["position", "orientation"]);
  });
});
