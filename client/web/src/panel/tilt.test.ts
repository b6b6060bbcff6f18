import type { JsonObject } from "@culet/protocol/messages";
import { expect, it, test } from "vitest";
import { object } from "../json";
import { directionOf, tiltOf, tiltPatch } from "./tilt";

const FACE_UP = { camera: { position: [0, 12.5, 0], target: [0, 0, 0], up: [0, 0, -1] } };
const ASIDE = { camera: { position: [3, 5, 0], target: [0, 1, 0], up: [0, 2, 0] } };

function cameraOf(patch: unknown): { position: number[]; up: number[] } {
  return object(object(patch).camera) as { position: number[]; up: number[] };
}

function expectNear(vector: number[], expected: number[]): void {
  for (const [k, value] of expected.entries()) expect(vector[k]).toBeCloseTo(value, 10);
}

test("a tilt is counted from straight above", () => {
  expect(tiltOf(FACE_UP)).toBe(0);
  expect(tiltOf(ASIDE)).toBeCloseTo((Math.atan2(3, 4) * 180) / Math.PI, 10);
  expect(tiltOf({ camera: { position: [0, -5, 0], target: [0, 0, 0] } })).toBeCloseTo(180, 10);
});

it("is made about what the camera looks at, at the same distance and on the same side", () => {
  const { position, up } = cameraOf(tiltPatch(ASIDE, 90));
  expectNear(position, [5, 1, 0]);
  expectNear(up, [0, 1, 0]);
});

it("goes from face up to the lower edge of the picture, as if the stone's far side were lifted", () => {
  const { position, up } = cameraOf(tiltPatch(FACE_UP, 30));
  expectNear(position, [0, 12.5 * Math.cos(Math.PI / 6), 12.5 / 2]);
  expectNear(up, [0, 0, -1]);
});

it("goes to any side, which is told again", () => {
  const { position, up } = cameraOf(tiltPatch(FACE_UP, 30, 90));
  expectNear(position, [12.5 / 2, 12.5 * Math.cos(Math.PI / 6), 0]);
  expectNear(up, [0, 0, -1]); // the picture stays upright
  expect(directionOf({ camera: { position, target: [0, 0, 0], up } })).toBeCloseTo(90, 10);
  expect(directionOf({ camera: { position: [-1, 2, 0], target: [0, 0, 0] } })).toBeCloseTo(270, 10);
  expect(directionOf(FACE_UP)).toBeNull();
});

it("never has the camera's up along its line of sight, on the way there or back", () => {
  let scene: JsonObject = FACE_UP;
  for (const tilt of [0, 45, 80, 90, 60, 10, 0]) {
    const camera = cameraOf(tiltPatch(scene, tilt));
    scene = { camera: { ...FACE_UP.camera, ...camera } };
    expect(tiltOf(scene)).toBeCloseTo(tilt, 5);
    const ray = camera.position.map((value) => value / 12.5);
    expect(Math.abs(ray.reduce((sum, value, k) => sum + value * (camera.up[k] ?? 0), 0))).toBeLessThan(0.95);
    expect(camera.position[2]).toBeGreaterThanOrEqual(0);
  }
});
