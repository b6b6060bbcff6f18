import { expect, it } from "vitest";
import { largestDifference, TOLERANCE } from "./trial";
import { PATCHES, SIDE } from "./trial-frames";

type Colour = readonly [number, number, number];

function pixels(colour: (x: number, y: number) => Colour): Uint8ClampedArray {
  const all = new Uint8ClampedArray(4 * SIDE * SIDE);
  for (let y = 0; y < SIDE; y += 1) {
    for (let x = 0; x < SIDE; x += 1) all.set([...colour(x, y), 255], 4 * (y * SIDE + x));
  }
  return all;
}

function shown(x: number, y: number): Colour {
  const patch = y < SIDE / 2 ? PATCHES[Math.floor((x * PATCHES.length) / SIDE)] : PATCHES[x % 2 === 0 ? 0 : 2];
  return patch ?? [0, 0, 0];
}

it("the picture itself, and one that is as near as encoders come, are trusted", () => {
  expect(largestDifference(pixels(shown))).toBe(0);
  const near = pixels((x, y) => shown(x, y).map((level) => level - 3) as unknown as Colour);
  expect(largestDifference(near)).toBeLessThanOrEqual(TOLERANCE);
});

it("a decoder that halves the chroma is not: stripes of red and blue become purple", () => {
  const [red, , blue] = PATCHES as [Colour, Colour, Colour];
  const purple = red.map((level, channel) => (level + (blue[channel] ?? 0)) / 2) as unknown as Colour;
  expect(largestDifference(pixels((x, y) => (y < SIDE / 2 ? shown(x, y) : purple)))).toBeGreaterThan(TOLERANCE);
});

it("a decoder that takes all levels for the limited ones is not", () => {
  const stretched = pixels((x, y) => shown(x, y).map((level) => ((level - 16) * 255) / 219) as unknown as Colour);
  expect(largestDifference(stretched)).toBeGreaterThan(TOLERANCE);
});
