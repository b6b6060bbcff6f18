import { expect, it } from "vitest";
import { FALL, fallLabel, PAUSE } from "./fall-button";

const scene = { stones: [{}] };

it("the button says what it does next", () => {
  expect(fallLabel({ scene, falling: false, asleep: false })).toBe(FALL);
  expect(fallLabel({ scene, falling: true, asleep: false })).toBe(PAUSE);
  expect(fallLabel({ scene, falling: true, asleep: true })).toBe(FALL); // it lies still, and is thrown again
});

it("there is no button without a stone, nor before the scene is known", () => {
  expect(fallLabel({ scene: { stones: [] }, falling: false, asleep: false })).toBeNull();
  expect(fallLabel({ scene: null, falling: false, asleep: false })).toBeNull();
});
