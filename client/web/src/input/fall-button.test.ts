import { expect, it } from "vitest";
import { words } from "../words/words";
import { fallLabel } from "./fall-button";

const { fall: FALL, pause: PAUSE } = words.fallButton;

const scene = { stones: [{}] };
const trio = { stones: [{}, {}, {}] };

it("the button says what it does next", () => {
  expect(fallLabel({ scene, falling: false, asleep: false })).toBe(FALL.one);
  expect(fallLabel({ scene, falling: true, asleep: false })).toBe(PAUSE);
  expect(fallLabel({ scene, falling: true, asleep: true })).toBe(FALL.one); // it lies still, and is thrown again
});

it("the button says that all stones fall", () => {
  expect(fallLabel({ scene: trio, falling: false, asleep: false })).toBe(FALL.several);
  expect(fallLabel({ scene: trio, falling: true, asleep: false })).toBe(PAUSE);
});

it("there is no button without a stone, nor before the scene is known", () => {
  expect(fallLabel({ scene: { stones: [] }, falling: false, asleep: false })).toBeNull();
  expect(fallLabel({ scene: null, falling: false, asleep: false })).toBeNull();
});
