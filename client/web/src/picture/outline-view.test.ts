import { expect, it } from "vitest";
import { polygonOf } from "./outline-view";

const CORNERS = [0, 0, 1, 1, -1, -1];

it("is measured from the picture's centre in halves of its height, y up", () => {
  const same = { width: 200, height: 100 };
  expect(polygonOf(CORNERS, same, same)).toBe("100,50 150,0 50,100");
});

it("follows the picture into a canvas of another size and shape", () => {
  expect(polygonOf(CORNERS, { width: 100, height: 100 }, { width: 300, height: 200 })).toBe("150,100 250,0 50,200");
});

it("has nothing to show of nothing", () => {
  expect(polygonOf([], { width: 1, height: 1 }, { width: 1, height: 1 })).toBe("");
});
