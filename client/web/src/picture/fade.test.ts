import { Flag } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { coveredAfter, FADE_MS, refines } from "./fade";

test("a picture comes up steadily, and is there at the end", () => {
  expect([0, FADE_MS / 3, FADE_MS, 10 * FADE_MS].map(coveredAfter)).toEqual([0, 1 / 3, 1, 1]);
  expect(coveredAfter(-5)).toBe(0); // an animation frame's clock may be a little behind
});

test("only another picture of what is seen already comes up, and none while things move", () => {
  expect(refines({ step: 4n, flags: Flag.FINAL }, 4n)).toBe(true);
  expect(refines({ step: 5n, flags: 0 }, 4n)).toBe(false);
  expect(refines({ step: 4n, flags: Flag.MOVING }, 4n)).toBe(false);
  expect(refines({ step: 4n, flags: 0 }, null)).toBe(false);
});
