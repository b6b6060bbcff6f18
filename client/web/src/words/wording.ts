/** Words about the stones of a scene, which has one or several. */

import type { JsonObject } from "@culet/protocol/messages";
import { stonesOf } from "../stones/stones";

/** A text as it reads where there is one stone, and where there are several. */
export interface Wording {
  readonly one: string;
  readonly several: string;
}

/** The text for a scene; one that does not depend on how many stones there are stays as it is. */
export function worded(text: string | Wording, scene: JsonObject | null): string {
  if (typeof text === "string") return text;
  return stonesOf(scene).length > 1 ? text.several : text.one;
}
