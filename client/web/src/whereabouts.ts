/** Where the stone is when the camera does not see it: what a black picture does not say. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, triple } from "./json";
import { hasStone, stoneOf } from "./scene-choices";

export type Whereabouts = "above" | "below" | "left" | "right" | "behind";
type Vector = readonly [number, number, number];

const HALF_TURN_DEGREES = 180;

/** On which side of the picture the whole of the stone is, before it falls, or null if some of it may be seen. */
export function whereabouts(scene: JsonObject | null, aspect: number): Whereabouts | null {
  const camera = part(scene, "camera");
  const [eye, target, stone] = [triple(camera.position), triple(camera.target), triple(stoneOf(scene).position)];
  if (!hasStone(scene) || !eye || !target || !stone) return null;
  const forward = unit(minus(target, eye));
  const right = unit(cross(forward, triple(camera.up) ?? [0, 1, 0]));
  const to = minus(stone, eye);
  const depth = dot(to, forward);
  if (depth < -1) return "behind"; // by R, the unit of length
  const half = (number(camera.fov_degrees, 40) / 2 / HALF_TURN_DEGREES) * Math.PI;
  const [x, y] = [dot(to, right), dot(to, cross(right, forward))];
  if (beyond(y, depth, half)) return y > 0 ? "above" : "below";
  if (beyond(x, depth, Math.atan(Math.tan(half) * aspect))) return x > 0 ? "right" : "left";
  return null;
}

/** Whether a sphere of radius 1 is wholly outside the plane at that angle from the line of sight. */
function beyond(across: number, depth: number, angle: number): boolean {
  return Math.abs(across) * Math.cos(angle) - depth * Math.sin(angle) > 1;
}

/** What to say about it, with the key that helps. */
export function whereaboutsText(where: Whereabouts | null): string | null {
  switch (where) {
    case null:
      return null;
    case "above":
      return "The stone is above the picture. P lets it fall, O moves the camera away.";
    case "behind":
      return "The stone is behind the camera. F puts the camera back.";
    case "below":
      return "The stone is below the picture. F puts the camera back.";
    default:
      return `The stone is to the ${where} of the picture. F puts the camera back.`;
  }
}

function minus([a, b, c]: Vector, [x, y, z]: Vector): Vector {
  return [a - x, b - y, c - z];
}

function dot([a, b, c]: Vector, [x, y, z]: Vector): number {
  return a * x + b * y + c * z;
}

function cross([a, b, c]: Vector, [x, y, z]: Vector): Vector {
  return [b * z - c * y, c * x - a * z, a * y - b * x];
}

function unit(vector: Vector): Vector {
  const length = Math.hypot(...vector);
  return [vector[0] / length, vector[1] / length, vector[2] / length];
}
