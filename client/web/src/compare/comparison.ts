/**
 * Two designs in one place, under one camera and light: one is shown, the other is kept, and a key changes them over.
 * What is kept is what the scene says of the stone, so that nothing but the design differs.
 */

import type { JsonObject } from "@culet/protocol/messages";
import { isObject, text } from "../json";
import { hasStone, stoneOf, withFirst } from "../stones/stones";

/** What a design is, of a stone; a merge patch takes a field away by null. */
const FIELDS = ["cut", "mesh", "recut", "material"] as const;
const POSE = ["position", "orientation"] as const;

interface Kept {
  design: JsonObject;
  /** Where the stone was that had it: another design lies on other facets. */
  pose: JsonObject;
}

/** A design in the place of a stone's own. */
export interface Beside {
  stone: string;
  design: JsonObject;
}

export class Comparison {
  private stone = "";
  private other: Kept | null = null;
  /** Where the stone was when the design that is shown took its place. */
  private came: JsonObject | null = null;

  /** Keep the design that the scene's stone has; false without a stone. */
  keep(scene: JsonObject | null, stone: string | null): boolean {
    const now = withFirst(scene, stone);
    if (!hasStone(now)) return false;
    this.stone = text(stoneOf(now).id, "");
    this.other = { design: only(FIELDS, now), pose: only(POSE, now) };
    this.came = null;
    return true;
  }

  /** Whether a design is kept of a stone that is there. */
  keeps(scene: JsonObject | null): boolean {
    return this.other !== null && this.among(scene) !== null;
  }

  /** The merge patch that shows the other design and keeps the one that is shown; null if none is kept of a stone there. */
  change(scene: JsonObject | null): JsonObject | null {
    const now = this.among(scene);
    if (!this.other || !now) return null;
    const { design, pose } = this.other;
    const left: Kept = { design: only(FIELDS, now), pose: only(POSE, now) };
    // A stone that was moved meanwhile is laid where it is now.
    const stayed = JSON.stringify(left.pose) === JSON.stringify(this.came ?? pose);
    this.other = left;
    this.came = stayed ? pose : null;
    const patch = replacing(left.design, design);
    return { stones: { [this.stone]: stayed ? { ...patch, ...pose } : patch } };
  }

  /** The scene as the other design would have it, its stone first; null if there is none to compare with. */
  otherwise(scene: JsonObject | null): JsonObject | null {
    const now = this.among(scene);
    if (!this.other || !now) return null;
    const same = JSON.stringify(this.other.design) === JSON.stringify(only(FIELDS, now));
    return same ? null : { ...now, stones: [{ ...stoneOf(now), ...this.other.design }] };
  }

  /**
   * The stone, and what is other about it as the other design has it, beside what is shown of the scene; null if there is
   * none to compare with. A stone that has been moved or has fallen lies as it is shown.
   */
  beside(shown: JsonObject, scene: JsonObject | null): Beside | null {
    const [now, seen] = [this.among(scene), this.among(shown)];
    if (!this.other || !now || !seen || !this.otherwise(scene)) return null;
    const { design, pose } = this.other;
    const places = [this.came ?? pose, only(POSE, now), only(POSE, seen)].map((place) => JSON.stringify(place));
    const laid = new Set(places).size === 1 ? { ...design, ...pose } : design;
    return { stone: this.stone, design: laid };
  }

  /** The scene with the stone first that is compared; null if it has gone. */
  private among(scene: JsonObject | null): JsonObject | null {
    const now = withFirst(scene, this.stone);
    return stoneOf(now).id === this.stone && this.stone !== "" ? now : null;
  }
}

function only(names: readonly string[], scene: JsonObject | null): JsonObject {
  const stone = stoneOf(scene);
  return Object.fromEntries(names.map((name) => [name, stone[name] ?? null]));
}

/** The merge patch that leaves nothing of `before`: what `after` does not have, such as the angle of a tier, is taken away. */
function replacing(before: JsonObject, after: JsonObject): JsonObject {
  const gone = Object.keys(before).filter((name) => !(name in after));
  const kept = Object.entries(after).map(([name, value]) => {
    const former = before[name];
    return [name, isObject(value) && isObject(former) ? replacing(former, value) : value];
  });
  return Object.fromEntries([...gone.map((name) => [name, null]), ...kept]);
}
