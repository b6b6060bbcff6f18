/** Drag, pinch and wheel as motions of the target. */

import type { Rectangle } from "../picture/picture-size";
import type { Push, Target } from "../session/events";
import { STEP } from "./actions";

/** What fingers did since the last look: css pixels dragged, and the ratio of a pinch. */
export interface Motion {
  dx: number;
  dy: number;
  /** Distance of two fingers now over before; 1: none. */
  spread: number;
}

/** Follows one or two pointers; more are ignored. */
export class Fingers {
  private readonly at = new Map<number, { x: number; y: number }>();

  down(id: number, x: number, y: number): void {
    if (this.at.size < 2) this.at.set(id, { x, y });
  }

  /** How many are down. */
  get count(): number {
    return this.at.size;
  }

  up(id: number): void {
    this.at.delete(id);
  }

  /** One finger drags, two pinch; null if the pointer is not followed. */
  move(id: number, x: number, y: number): Motion | null {
    const before = this.at.get(id);
    if (!before) return null;
    const spreadBefore = this.spread();
    this.at.set(id, { x, y });
    if (this.at.size === 1) return { dx: x - before.x, dy: y - before.y, spread: 1 };
    const ratio = this.spread() / spreadBefore;
    return { dx: 0, dy: 0, spread: Number.isFinite(ratio) && ratio > 0 ? ratio : 1 };
  }

  private spread(): number {
    const [a, b] = [...this.at.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 1;
  }
}

/**
 * A drag over the picture's shorter side (css pixels) is half a turn. The camera goes against the finger, so that the
 * scene seems to be held; a light goes with it, and so does the near side of a stone.
 */
export function turnBy(dx: number, dy: number, side: number, target: Target): { yaw: number; pitch: number } {
  const radians = Math.PI / Math.max(side, 1);
  const sign = target === "camera" ? -1 : 1;
  return { yaw: sign * dx * radians, pitch: -sign * dy * radians };
}

/** R/s for a drag over half the picture's height. */
const PUSH = 6;
/** R/s: the most that one blow gives. */
const PUSH_LIMIT = 10;

/** A place on the canvas, css pixels, as the picture in that area has it: halves of its height from its centre, y up. */
export function placeOf(x: number, y: number, area: Rectangle): { x: number; y: number } {
  const half = Math.max(area.height, 1) / 2;
  return { x: (x - area.x - area.width / 2) / half, y: (area.y + area.height / 2 - y) / half };
}

/** A drag that began at (x, y) on a canvas with the picture in that area, css pixels, as a blow at that place. */
export function pushBy(x: number, y: number, dx: number, dy: number, area: Rectangle): Push {
  const half = Math.max(area.height, 1) / 2;
  const blow = (pixels: number) => Math.max(-PUSH_LIMIT, Math.min(PUSH_LIMIT, (PUSH * pixels) / half));
  return { type: "push", ...placeOf(x, y, area), right: blow(dx), up: blow(-dy) };
}

/** R for a doubling of the distance between two fingers. */
const PINCH = 2;

/** R forward. */
export function pinchBy(spread: number): number {
  return PINCH * Math.log2(spread);
}

/** Css pixels in a notch of most wheels, and in the line and page of WheelEvent.deltaMode 1 and 2. */
const NOTCH = 100;
const UNIT = [1, 16, 800];
/** R: the most that one wheel event moves, since some mice report bursts. */
const WHEEL_LIMIT = 2;

/** R forward. */
export function wheelBy(deltaY: number, deltaMode: number): number {
  const forward = (-deltaY * (UNIT[deltaMode] ?? 1) * STEP) / NOTCH;
  return Math.max(-WHEEL_LIMIT, Math.min(WHEEL_LIMIT, forward));
}
