import { expect, it, test } from "vitest";
import { object } from "../json";
import { tiltOf, tiltPatch } from "./tilt";

const FACE_UP = { camera: { position: [0, 12.5, 0.001], target: [0, 0, 0], up: [0, 1, 0] } };
const ASIDE = { camera: { position: [3, 5, 0], target: [0, 1, 0], up: [0, 2, 0] } };

function positionOf(patch: unknown): number[] {
  return object(object(patch).camera).position as number[];
}

test("a tilt is counted from straight above", () => {
  expect(tiltOf(FACE_UP)).toBeLessThan(0.005);
  expect(tiltOf(ASIDE)).toBeCloseTo((Math.atan2(3, 4) * 180) / Math.PI, 10);
  expect(tiltOf({ camera: { position: [0, -5, 0], target: [0, 0, 0] } })).toBeCloseTo(180, 10);
});

it("is made about what the camera looks at, at the same distance and on the same side", () => {
  const position = positionOf(tiltPatch(ASIDE, 90));
  expect(position[0]).toBeCloseTo(5, 10);
  expect(position[1]).toBeCloseTo(1, 10);
  expect(position[2]).toBeCloseTo(0, 10);
});

it("is what was asked for, from face up too, in the direction in which the camera stood", () => {
  for (const tilt of [10, 45, 120]) {
    const position = positionOf(tiltPatch(FACE_UP, tilt));
    expect(tiltOf({ camera: { ...FACE_UP.camera, position } })).toBeCloseTo(tilt, 8);
    expect(position[2]).toBeGreaterThan(0);
  }
});

it("never looks along the camera's own up, from where there would be no upright picture", () => {
  const above = { camera: { position: [0, 7, 0], target: [0, 0, 0] } };
  const position = positionOf(tiltPatch(above, 0));
  expect(Math.hypot(position[0] ?? 0, position[2] ?? 0)).toBeGreaterThan(1e-4);
  expect(Math.hypot(...position)).toBeCloseTo(7, 10);
});
