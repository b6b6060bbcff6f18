/** How far the camera is tilted from looking straight down on the stones, and the merge patch that tilts it. */

import type { JsonObject } from "@culet/protocol/messages";
import { part, triple } from "../json";

type Vector = readonly [number, number, number];

const VERTICAL: Vector = [0, 1, 0];
/** Cosine of the angle from which on the camera's up counts as along its line of sight: 20 degrees. */
const ALONG = 0.94;
/** R, of what counts as no way aside. */
const NOTHING = 1e-6;

/** Degrees from straight above to where the camera stands, seen from what it looks at: 0 face up, 90 from the side. */
export function tiltOf(scene: JsonObject | null): number {
  const { offset } = standOf(scene);
  return (Math.acos(Math.min(Math.max(unit(offset)[1], -1), 1)) * 180) / Math.PI;
}

/**
 * The camera at that tilt, as far off as it was, toward a direction as of `directionOf`; without one, on the side on which
 * it stood, from straight above on the side of the picture's lower edge. An up that would lie along the line of sight gives way to one that leaves the picture upright.
 */
export function tiltPatch(scene: JsonObject | null, tilt: number, toward?: number): JsonObject {
  const { offset, up, target } = standOf(scene);
  const level = toward === undefined ? sideOf(offset, up) : levelAt(toward);
  const angle = (tilt * Math.PI) / 180;
  const ray = plus(scaled(VERTICAL, Math.cos(angle)), scaled(level, Math.sin(angle)));
  const position = plus(target, scaled(ray, Math.hypot(...offset)));
  const upright = Math.abs(dot(ray, up)) < ALONG ? up : tilt < 45 ? scaled(level, -1) : VERTICAL;
  return { camera: { position: [...position], up: [...upright] } };
}

/** Degrees from +z toward +x of the side on which the camera stands; null straight above, where it stands on none. */
export function directionOf(scene: JsonObject | null): number | null {
  const level = levelOf(standOf(scene).offset);
  return level && ((Math.atan2(level[0], level[2]) * 180) / Math.PI + 360) % 360;
}

function sideOf(offset: Vector, up: Vector): Vector {
  return levelOf(offset) ?? levelOf(scaled(up, -1)) ?? [0, 0, 1];
}

function levelAt(degrees: number): Vector {
  const angle = (degrees * Math.PI) / 180;
  return [Math.sin(angle), 0, Math.cos(angle)];
}

function standOf(scene: JsonObject | null): { offset: Vector; up: Vector; target: Vector } {
  const camera = part(scene, "camera");
  const target = triple(camera.target) ?? [0, 0, 0];
  const offset = plus(triple(camera.position) ?? [0, 1, 1], scaled(target, -1));
  return { offset, up: unit(triple(camera.up) ?? VERTICAL), target };
}

/** The direction of a way on the ground; null of one that goes up and down alone. */
function levelOf([x, , z]: Vector): Vector | null {
  return Math.hypot(x, z) > NOTHING ? unit([x, 0, z]) : null;
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function plus(a: Vector, b: Vector): Vector {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

function scaled(a: Vector, by: number): Vector {
  return [a[0] * by, a[1] * by, a[2] * by];
}

function unit(a: Vector): Vector {
  return scaled(a, 1 / (Math.hypot(...a) || 1));
}
