import { expect, test } from "vitest";
import { ACTIONS, actionNamed, labelWithKey } from "./actions";

test("a label names its key as it is printed", () => {
  expect(labelWithKey(actionNamed("reset_camera"))).toBe("Reset the camera  [F]");
  expect(labelWithKey(actionNamed("left"))).toBe("Left  [\u2190]");
  expect(labelWithKey(actionNamed("light_1"))).toBe("Move the red light  [1]");
});

test("a label tells whether its action is for one stone or for all", () => {
  const trio = { stones: [{}, {}, {}] };
  expect(labelWithKey(actionNamed("reset_stone"))).toBe("Put the stone back  [R]");
  expect(labelWithKey(actionNamed("reset_stone"), trio)).toBe("Put the stones back  [R]");
  expect(labelWithKey(actionNamed("remove_stone"), trio)).toBe("Remove the chosen stone  [Del]");
});

test("names are unique, and an unknown one is an error that lists them", () => {
  expect(new Set(ACTIONS.map(({ name }) => name)).size).toBe(ACTIONS.length);
  expect(() => actionNamed("jump")).toThrow(/expected one of camera, .*, got jump/);
});

const TURNS = ["turn_left", "turn_right", "turn_up", "turn_down"];

test("only moves repeat while a key is held", () => {
  const repeating = ACTIONS.filter(({ repeats }) => repeats).map(({ name }) => name);
  expect(repeating).toEqual(["left", "right", "up", "down", "in", "out", ...TURNS]);
});
