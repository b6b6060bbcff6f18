import { expect, it, test } from "vitest";
import { withParts } from "./scene-parts";

const RUBY = { id: "ruby", scale: 1 };
const GLASS = { id: "glass", scale: 2 };
const SCENE = { version: 2, camera: { fov: 30 }, head: { size: 1 }, stones: [RUBY, GLASS] };

test.each([
  ["a part", { camera: { fov: 20 } }, { ...SCENE, camera: { fov: 20 } }],
  ["a part that is none any more", { head: null }, { ...SCENE, head: null }],
  ["one stone", { "stones.glass": { ...GLASS, scale: 3 } }, { ...SCENE, stones: [RUBY, { ...GLASS, scale: 3 }] }],
  ["a stone less", { "stones.ruby": null }, { ...SCENE, stones: [GLASS] }],
  ["a stone more", { "stones.new": { id: "new" } }, { ...SCENE, stones: [RUBY, GLASS, { id: "new" }] }],
  ["another order", { stones: [GLASS, RUBY] }, { ...SCENE, stones: [GLASS, RUBY] }],
])("%s", (_, parts, after) => {
  expect(withParts(SCENE, parts)).toEqual(after);
});

it("leaves what did not change as it was", () => {
  const after = withParts(SCENE, { "stones.glass": null });
  expect(after.camera).toBe(SCENE.camera);
  expect((after.stones as unknown[])[0]).toBe(RUBY);
  expect(SCENE.stones).toEqual([RUBY, GLASS]);
});
