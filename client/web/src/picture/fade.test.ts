import { Flag } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { coveredAfter, FADE_MS, isWorse, refines } from "./fade";

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

test("a picture of more pixels is waited for until it is no worse to look at than the finished one before", () => {
  const shown = { step: 4n, flags: Flag.FINAL, width: 1920, height: 1080, shownError: 0.004 };
  const sharp = (shownError: number) => ({ step: 4n, flags: 0, width: 3840, height: 2160, shownError });
  expect([Number.NaN, 0.02, 0.0081].map((error) => isWorse(sharp(error), shown))).toEqual([true, true, true]);
  expect(isWorse(sharp(0.008), shown)).toBe(false);
  expect(isWorse({ ...sharp(0.02), width: 1920, height: 1080 }, shown)).toBe(false); // as after another viewer's wish
});

test("a picture of another state, or one that moves, is never waited with", () => {
  const shown = { step: 4n, flags: Flag.FINAL, width: 1920, height: 1080, shownError: 0.004 };
  const other = { step: 5n, flags: 0, width: 3840, height: 2160, shownError: 0.1 };
  expect(isWorse(other, shown)).toBe(false);
  expect(isWorse({ ...other, step: 4n, flags: Flag.MOVING }, shown)).toBe(false);
  expect(isWorse(other, null)).toBe(false);
  expect(isWorse({ ...other, step: 4n }, { ...shown, shownError: Number.NaN })).toBe(false);
});

test("a picture that its link reduced does not take the place of the finished one while it has more noise", () => {
  const shown = { step: 4n, flags: Flag.FINAL, width: 1920, height: 1080, shownError: 0.004 };
  const reduced = { ...shown, flags: Flag.THRIFTY, shownError: 0.02 };
  expect(isWorse(reduced, shown)).toBe(true);
  expect(isWorse({ ...reduced, width: 1280, height: 720 }, shown)).toBe(true);
  expect(isWorse({ ...reduced, shownError: Number.NaN }, shown)).toBe(true);
  expect(isWorse({ ...reduced, shownError: 0.004 }, shown)).toBe(false);
  expect(isWorse({ ...reduced, width: 1280, height: 1024 }, shown)).toBe(false); // another viewer's window
  expect(isWorse(reduced, { ...shown, flags: 0 })).toBe(false); // not finished: whatever comes is news
  expect(isWorse({ ...reduced, step: 5n }, shown)).toBe(false);
});
