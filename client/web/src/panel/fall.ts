/** How the stone falls, as a scene says it, and the merge patches that change it. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Option } from "../controls/choice";
import { number, part, text, triple } from "../json";
import { stoneOf, stonePatch } from "../stones/stones";
import { words } from "../words/words";

export interface Fall {
  /** R: how far above the floor the stone's bounding sphere starts. */
  height: number;
  /** rad/s at the start. */
  spin: number;
  /** R/s². */
  gravity: number;
  restitution: number;
  friction: number;
  /** R. */
  rolling: number;
  model: string;
  integrator: string;
}

export type Direction = readonly [number, number, number];

/** The settings that the report's model does not know. */
export const OF_RIGID = ["friction", "rolling", "integrator"] as const;

export const MODELS: readonly Option<string>[] = [
  { label: words.fall.rigid, value: "rigid" },
  { label: words.fall.classic, value: "classic" },
];

/** The scene's before there is one. */
export const NOTHING_FALLS: Fall = {
  height: 0,
  spin: 0,
  gravity: 9.81,
  restitution: 0.6,
  friction: 0.3,
  rolling: 0.02,
  model: "rigid",
  integrator: "",
};

const UPRIGHT: Direction = [0, 1, 0];

export function fallOf(scene: JsonObject | null): Fall {
  const simulation = part(scene, "simulation");
  const none = NOTHING_FALLS;
  return {
    height: triple(stoneOf(scene).position)?.[1] ?? none.height,
    spin: Math.hypot(...(triple(stoneOf(scene).spin) ?? [none.spin])),
    gravity: number(simulation.gravity, none.gravity),
    restitution: number(simulation.restitution, none.restitution),
    friction: number(simulation.friction, none.friction),
    rolling: number(simulation.rolling_resistance, none.rolling),
    model: text(simulation.model, none.model),
    integrator: text(simulation.integrator, none.integrator),
  };
}

/** The axis about which the scene's stone starts to turn, or null if it does not turn. */
export function spinAxis(scene: JsonObject | null): Direction | null {
  const spin = triple(stoneOf(scene).spin);
  const speed = spin ? Math.hypot(...spin) : 0;
  return spin && speed > 0 ? [spin[0] / speed, spin[1] / speed, spin[2] / speed] : null;
}

/** The merge patch that changes one setting; `axis` is what a stone turns about that did not turn. */
export function fallPatch<K extends keyof Fall>(
  scene: JsonObject | null,
  name: K,
  value: Fall[K],
  axis: Direction = UPRIGHT,
): JsonObject {
  switch (name) {
    case "height": {
      const [x, , z] = triple(stoneOf(scene).position) ?? [0, 0, 0];
      return stonePatch(scene, { position: [x, value, z] });
    }
    case "spin": {
      const about = spinAxis(scene) ?? axis;
      return stonePatch(scene, { spin: about.map((component) => component * Number(value)) });
    }
    default:
      return { simulation: { [name === "rolling" ? "rolling_resistance" : name]: value } };
  }
}
