import { encode } from "uqr";
import { expect, it } from "vitest";
import { BORDER, squares } from "./qr-code";

it("has a square for each dark module, and a border that is white", () => {
  expect(
    squares([
      [true, false],
      [false, true],
    ]),
  ).toBe("M0 0h1v1h-1zM1 1h1v1h-1z");
  const { data, size } = encode("https://culet.test/?watch=0123456789abcdef0123456789abcdef", {
    ecc: "M",
    border: BORDER,
  });
  const drawn = squares(data).match(/M\d+ \d+/g) ?? [];
  expect(drawn.length).toBe(data.flat().filter(Boolean).length);
  const places = drawn.flatMap((place) => place.slice(1).split(" ").map(Number));
  expect(Math.min(...places)).toBe(BORDER);
  expect(Math.max(...places)).toBe(size - 1 - BORDER);
});
