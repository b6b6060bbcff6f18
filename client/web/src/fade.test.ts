import { expect, test } from "vitest";
import { coveredAfter, FADE_MS } from "./fade";

test("a picture comes up steadily, and is there at the end", () => {
  expect([0, FADE_MS / 3, FADE_MS, 10 * FADE_MS].map(coveredAfter)).toEqual([0, 1 / 3, 1, 1]);
  expect(coveredAfter(-5)).toBe(0); // an animation frame's clock may be a little behind
});
