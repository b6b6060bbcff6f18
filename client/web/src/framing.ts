/** How far off the camera of a new session is: what it frames should fit a window that is higher than wide, too. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, triple } from "./json";

/** Width by height. A camera's angle is that of its picture's height; a picture narrower than this takes it farther off. */
const NARROWEST = 0.7;

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
  if (!position || !target || !(aspect > 0) || aspect >= NARROWEST) return null;
  const farther = NARROWEST / aspect;
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
