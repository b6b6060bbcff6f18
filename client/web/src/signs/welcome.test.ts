import { expect, it } from "vitest";
import { firstSteps, isFirst } from "./welcome";

it("is shown on the first visit alone", () => {
  const kept = new Map<string, string>();
  const memory = {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => void kept.set(key, value),
  };
  expect(isFirst(() => memory)).toBe(true);
  expect(isFirst(() => memory)).toBe(false);
});

it("is not shown again and again where a browser forbids to remember", () => {
  const forbidden = () => {
    throw new Error("denied");
  };
  expect(isFirst(forbidden)).toBe(false);
});

it("names keys to those who have them, and the button to fingers", () => {
  expect(firstSteps(false)).toContain("P lets it fall");
  expect(firstSteps(true)).toContain("round button");
  expect(firstSteps(true)).not.toContain("?");
});
