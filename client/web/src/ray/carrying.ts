/** A path that goes along with its stones: where its lines are once the stones are elsewhere. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, triple } from "../json";
import type { Pass, Path, Pose, Step } from "../session/answers";
import { stoneOf } from "../stones/stones";
import { minus, plus, type Quaternion, times, turned, turnedBack, type Vector } from "./vectors";

/** One chain's line of one step. */
export interface Line {
  step: Step;
  pass: Pass;
  from: Vector;
  to: Vector;
}

type Move = (point: Vector) => Vector;

/** The lines of a path in a scene whose stones may have moved since. What is outside goes along with the stone it left, and
 *  the eye's ray with the first one that it meets. */
export function carried(path: Path, scene: JsonObject | null): Line[] {
  const moves = new Map<string, Move>();
  for (const [id, before] of Object.entries(path.poses)) moves.set(id, moveOf(before, stoneOf(scene, id)));
  const first = path.steps.find((step) => step.stone)?.stone;
  const stay: Move = (point) => point;
  const ofStone = (id: string | null | undefined) => (id ? moves.get(id) : undefined) ?? stay;
  const byStep: Move[] = [];
  return path.steps.flatMap((step) => {
    const before = step.parent === null ? ofStone(first) : (byStep[step.parent] ?? stay);
    const here = step.stone ? ofStone(step.stone) : before;
    byStep[step.number] = here;
    return step.passes.map((pass) => ({ step, pass, from: before(pass.start), to: here(pass.point) }));
  });
}

function moveOf(before: Pose, stone: JsonObject): Move {
  const position = triple(stone.position) ?? before.position;
  const orientation = quaternion(stone.orientation) ?? before.orientation;
  const scale = number(stone.scale, before.scale) / before.scale;
  return (point) => {
    const own = turnedBack(before.orientation, minus(point, before.position));
    return plus(position, times(scale, turned(orientation, own)));
  };
}

function quaternion(value: unknown): Quaternion | null {
  const numbers = Array.isArray(value) ? value.filter((one) => typeof one === "number") : [];
  return numbers.length === 4 ? (numbers as unknown as Quaternion) : null;
}
