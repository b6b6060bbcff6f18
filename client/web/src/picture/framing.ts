/** How far off the camera of a new session is: what it frames should fit a window that is higher than wide, too. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, triple } from "../json";
import { stonesOf } from "../stones/stones";

type Vector = readonly [number, number, number];

/** Width by height. A camera's angle is that of its picture's height; a picture narrower than this takes it farther off. */
const NARROWEST = 0.7;
/** The shape that scenes are made for: what is beyond its sides is not framed. */
const WIDEST = 16 / 9;

/** Degrees, of a camera that says nothing else. */
const FIELD_OF_VIEW = 13.5;

/** R, of what an orthographic camera shows that says nothing else. */
const ORTHOGRAPHIC_HEIGHT = 3;

/** The scene with room for what its camera frames in a picture of that shape. */
export function framed(scene: JsonObject, aspect: number): JsonObject {
  const patch = framingPatch(scene, aspect);
  return patch ? { ...scene, camera: { ...part(scene, "camera"), ...part(patch, "camera") } } : scene;
}

/** The merge patch that makes room for what the camera frames, or null if there is room. */
export function framingPatch(scene: JsonObject | null, aspect: number): JsonObject | null {
  const camera = part(scene, "camera");
  const [position, target] = [triple(camera.position), triple(camera.target)];
  if (!position || !target || !(aspect > 0) || aspect >= WIDEST) return null;
  const wanted = wantedAspect(scene, position, target);
  if (aspect >= wanted) return null;
  const farther = wanted / aspect;
  // Parallel rays show as much from farther off.
  if (camera.kind === "orthographic")
    return { camera: { height: number(camera.height, ORTHOGRAPHIC_HEIGHT) * farther } };
  const along = (from: number, to: number) => to + (from - to) * farther;
  return {
    camera: {
      position: [along(position[0], target[0]), along(position[1], target[1]), along(position[2], target[2])],
    },
  };
}

/** Of a picture with room for the balls about all stones, if there are several, that the camera frames: width by height. */
function wantedAspect(scene: JsonObject | null, position: Vector, target: Vector): number {
  if (stonesOf(scene).length < 2) return NARROWEST;
  const camera = part(scene, "camera");
  const forward = unit(minus(target, position));
  const right = unit(cross(forward, triple(camera.up) ?? [0, 1, 0]));
  const tangent = Math.tan((number(camera.fov_degrees, FIELD_OF_VIEW) * Math.PI) / 360);
  const halves = stonesOf(scene).map((stone) => {
    const offset = minus(triple(stone.position) ?? target, position);
    const [radius, depth] = [number(stone.scale, 1), dot(offset, forward)];
    const half = camera.kind === "orthographic" ? number(camera.height, ORTHOGRAPHIC_HEIGHT) / 2 : depth * tangent;
    const aside = (Math.abs(dot(offset, right)) + radius) / half;
    return depth > radius && aside <= WIDEST ? aside : 0;
  });
  return Math.max(NARROWEST, ...halves);
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(v: Vector): Vector {
  const length = Math.hypot(...v) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}
