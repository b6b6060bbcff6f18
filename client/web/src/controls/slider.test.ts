import { expect, it } from "vitest";
import { shortened, within } from "./slider";

const PERCENT = { least: 0.5, most: 10, step: 0.05, decimals: 2 };

it("steps from its start, without the noise of adding steps", () => {
  expect(within(0.5 + 3 * 0.05, PERCENT)).toBe(0.65);
  expect(within(3.02, PERCENT)).toBe(3);
  expect(within(3.03, PERCENT)).toBe(3.05);
});

it("stays between its ends", () => {
  expect(within(0.45, PERCENT)).toBe(0.5);
  expect(within(10.05, PERCENT)).toBe(10);
});

it("shows no more decimals than it steps by, and no zeros at the end", () => {
  expect(shortened(40.75, PERCENT)).toBe("40.75");
  expect(shortened(3, PERCENT)).toBe("3");
  expect(shortened(-0.373345, PERCENT)).toBe("-0.37");
});
