import { expect, test } from "vitest";
import { Projection } from "./projection";

const CAMERA = { position: [0, 0, 10], target: [0, 0, 0], up: [0, 1, 0], fov_degrees: 90 };

test("a place at the edge of what a camera of 90 degrees sees is half a height from the middle", () => {
  const seen = new Projection({ camera: CAMERA }).line([0, 0, 0], [10, -5, 0]);
  expect(seen?.[0]).toEqual([0, 0]);
  expect(seen?.[1][0]).toBeCloseTo(1);
  expect(seen?.[1][1]).toBeCloseTo(-0.5);
});

test("parallel rays show as much of what is far as of what is near", () => {
  const projection = new Projection({ camera: { ...CAMERA, kind: "orthographic", height: 4 } });
  const seen = projection.line([1, 0, 0], [1, 0, -50]);
  expect(seen?.[0][0]).toBeCloseTo(0.5);
  expect(seen?.[1][0]).toBeCloseTo(0.5);
});

test("of a line that begins behind the eye only what lies before it is seen", () => {
  const projection = new Projection({ camera: CAMERA });
  expect(projection.line([0, 0, 11], [0, 0, 12])).toBeNull();
  const seen = projection.line([1, 0, 20], [1, 0, 0]);
  expect(seen?.[0][0]).toBeGreaterThan(50); // close to the eye, far aside
  expect(seen?.[1][0]).toBeCloseTo(0.1);
});
