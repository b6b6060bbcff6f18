/** Moves of what a viewer has chosen to move, the camera, a light or a stone, as events. */

import type { Dolly, DragStone, MoveStone, Orbit, Translate, TurnStone } from "@culet/protocol/messages";
import type { Target } from "../session/events";

/** Along the camera's axes, R, and about them, radians. */
export interface Move {
  right?: number;
  up?: number;
  forward?: number;
  yaw?: number;
  pitch?: number;
}

/** What of a step of the camera a stone makes: stones are put exactly, and are smaller than what is about them. */
const OF_A_STONE = 0.2;

export type Moving = Orbit | Translate | Dolly | MoveStone | TurnStone;

/** The events that make a move; `stone` is the id of the stone that moves if the target is a stone. */
export function movesOf(move: Move, target: Target, stone: string): Moving[] {
  const { right = 0, up = 0, forward = 0, yaw = 0, pitch = 0 } = move;
  const events: Moving[] = [];
  if (target === "stone") {
    const [a, b, c] = [right * OF_A_STONE, up * OF_A_STONE, forward * OF_A_STONE];
    if (a !== 0 || b !== 0 || c !== 0) events.push({ type: "move_stone", stone, right: a, up: b, forward: c });
    if (yaw !== 0 || pitch !== 0) events.push({ type: "turn_stone", stone, yaw, pitch, roll: 0 });
    return events;
  }
  if (yaw !== 0 || pitch !== 0) events.push({ type: "orbit", target, yaw, pitch });
  if (right !== 0 || up !== 0) events.push({ type: "translate", target, right, up });
  if (forward !== 0) events.push({ type: "dolly", target, forward });
  return events;
}

/** A drag over the picture, css pixels, of a stone that stays under the finger; `height` is the picture's. */
export function dragOf(stone: string, dx: number, dy: number, height: number): DragStone {
  const half = Math.max(height, 1) / 2;
  return { type: "drag_stone", stone, right: dx / half, up: -dy / half };
}
