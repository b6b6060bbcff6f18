import { expect, it } from "vitest";
import { dragOf, movesOf } from "./moves";

it.each(["camera", "light_1"] as const)("a move of the %s is one event for each of its kinds", (target) => {
  expect(movesOf({ right: 0.5 }, target, "ruby")).toEqual([{ type: "translate", target, right: 0.5, up: 0 }]);
  expect(movesOf({ yaw: 0.1, pitch: -0.2, forward: 1 }, target, "ruby")).toEqual([
    { type: "orbit", target, yaw: 0.1, pitch: -0.2 },
    { type: "dolly", target, forward: 1 },
  ]);
});

it("a stone moves by a fifth of that, and turns about itself", () => {
  expect(movesOf({ right: 0.5, forward: -1 }, "stone", "ruby")).toEqual([
    { type: "move_stone", stone: "ruby", right: 0.1, up: 0, forward: -0.2 },
  ]);
  expect(movesOf({ yaw: 0.1, pitch: -0.2 }, "stone", "ruby")).toEqual([
    { type: "turn_stone", stone: "ruby", yaw: 0.1, pitch: -0.2, roll: 0 },
  ]);
});

it("nothing that moves is no event", () => {
  expect(movesOf({ yaw: 0, forward: 0 }, "camera", "")).toEqual([]);
  expect(movesOf({}, "stone", "ruby")).toEqual([]);
});

it("a drag counts in halves of the picture's height, and up", () => {
  expect(dragOf("ruby", 50, -25, 200)).toEqual({ type: "drag_stone", stone: "ruby", right: 0.5, up: 0.25 });
  expect(Number.isFinite(dragOf("ruby", 1, 1, 0).up)).toBe(true);
});
