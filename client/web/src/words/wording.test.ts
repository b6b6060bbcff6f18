import { expect, it } from "vitest";
import { worded } from "./wording";

const WORDS = { one: "the stone", several: "the stones" };

it("words are of several stones only where there are several", () => {
  expect(worded(WORDS, null)).toBe("the stone");
  expect(worded(WORDS, { stones: [] })).toBe("the stone");
  expect(worded(WORDS, { stones: [{ id: "ruby" }] })).toBe("the stone");
  expect(worded(WORDS, { stones: [{ id: "ruby" }, { id: "glass" }] })).toBe("the stones");
});

it("a text that is the same for any number stays", () => {
  expect(worded("walls", { stones: [{}, {}] })).toBe("walls");
});
