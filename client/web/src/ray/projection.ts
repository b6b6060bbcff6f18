/** Where places of the world are in the picture, by the scene's camera: as the server's projection.py has it. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, triple } from "../json";
import { cross, dot, minus, plus, times, unit, type Vector } from "./vectors";

/** Right and up from the picture's centre, in halves of its height. */
export type PicturePoint = readonly [number, number];

/** Of a camera that says nothing else: that of the default scene. */
const POSITION: Vector = [0, 8.146, 11.032];
const TARGET: Vector = [0, -0.473, 0];
const FIELD_OF_VIEW = 13.5;
const ORTHOGRAPHIC_HEIGHT = 3;
/** R before the eye, from which on places are seen. */
const NEAR = 0.01;

export class Projection {
  private readonly eye: Vector;
  private readonly forward: Vector;
  private readonly right: Vector;
  private readonly up: Vector;
  /** Half of what is seen: R of parallel rays, else per R of depth. */
  private readonly half: number;
  private readonly parallel: boolean;

  constructor(scene: JsonObject | null) {
    const camera = part(scene, "camera");
    this.eye = triple(camera.position) ?? POSITION;
    this.forward = unit(minus(triple(camera.target) ?? TARGET, this.eye));
    this.right = unit(cross(this.forward, triple(camera.up) ?? [0, 1, 0]));
    this.up = cross(this.right, this.forward);
    this.parallel = camera.kind === "orthographic";
    this.half = this.parallel
      ? number(camera.height, ORTHOGRAPHIC_HEIGHT) / 2
      : Math.tan((number(camera.fov_degrees, FIELD_OF_VIEW) * Math.PI) / 360);
  }

  /** Both ends of what is seen of a line; null if it lies behind the eye. */
  line(from: Vector, to: Vector): readonly [PicturePoint, PicturePoint] | null {
    const [near, far] = [this.depth(from), this.depth(to)];
    if (this.parallel) return [this.place(from), this.place(to)];
    if (near < NEAR && far < NEAR) return null;
    const cut = plus(from, times((NEAR - near) / (far - near || 1), minus(to, from)));
    return [this.place(near < NEAR ? cut : from), this.place(far < NEAR ? cut : to)];
  }

  private depth(point: Vector): number {
    return dot(minus(point, this.eye), this.forward);
  }

  private place(point: Vector): PicturePoint {
    const apart = minus(point, this.eye);
    const scale = this.half * (this.parallel ? 1 : Math.max(this.depth(point), NEAR / 2));
    return [dot(apart, this.right) / scale, dot(apart, this.up) / scale];
  }
}
