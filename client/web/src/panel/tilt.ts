/** How far the camera is tilted from looking straight down on the stones, and the merge patch that tilts it. */

import type { JsonObject } from "@culet/protocol/messages";
import { part, triple } from "../json";

type Vector = readonly [number, number, number];

/** Degrees: straight down, the camera's up would be parallel to its line of sight. */
const STEEPEST = 0.01;

/** Degrees from the camera's up to where it stands, seen from what it looks at: 0 face up, 90 from the side. */
export function tiltOf(scene: JsonObject | null): number {
  const { offset, up } = standOf(scene);
  return degrees(Math.acos(Math.min(Math.max(dot(unit(offset), up), -1), 1)));
}

/** The camera at that tilt, as far off as it was, in the direction in which it stood. */
export function tiltPatch(scene: JsonObject | null, tilt: number): JsonObject {
  const { offset, up, target } = standOf(scene);
  const aside = minus(offset, scaled(up, dot(offset, up)));
  const level = Math.hypot(...aside) > 0 ? unit(aside) : anyLevel(up);
  const angle = (Math.max(tilt, STEEPEST) * Math.PI) / 180;
  const distance = Math.hypot(...offset);
  const at = (k: 0 | 1 | 2) => target[k] + distance * (Math.cos(angle) * up[k] + Math.sin(angle) * level[k]);
  return { camera: { position: [at(0), at(1), at(2)] } };
}

function standOf(scene: JsonObject | null): { offset: Vector; up: Vector; target: Vector } {
  const camera = part(scene, "camera");
  const target = triple(camera.target) ?? [0, 0, 0];
  const offset = minus(triple(camera.position) ?? [0, 1, 1], target);
  return { offset, up: unit(triple(camera.up) ?? [0, 1, 0]), target };
}

/** A direction across `up`, whichever. */
function anyLevel(up: Vector): Vector {
  const other: Vector = Math.abs(up[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  return unit(minus(other, scaled(up, dot(other, up))));
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function scaled(a: Vector, by: number): Vector {
  return [a[0] * by, a[1] * by, a[2] * by];
}

function unit(a: Vector): Vector {
  return scaled(a, 1 / (Math.hypot(...a) || 1));
}

function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}
