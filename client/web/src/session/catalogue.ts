/** What the server offers to choose from, and what it says of an upload: the types of its answers. */

import type { JsonObject } from "@culet/protocol/messages";

/** Something that a scene can name. */
export interface Catalogued {
  name: string;
  summary: string;
}

/** Something of which a scene's name is not what people call it. */
export interface Titled extends Catalogued {
  title: string;
}

export interface Preset extends Titled {
  group: string;
  /** Address of a small picture. */
  thumbnail: string;
  scene: JsonObject;
}

export interface Material extends Titled {
  /** It absorbs by a spectrum of its own. */
  coloured: boolean;
  /** Indices of refraction for red, green and blue. */
  indices: readonly [number, number, number];
}

/** An uploaded mesh or sky: its id for the scene, and sentences about it for the user. */
export interface Upload {
  id: string;
  findings: string[];
}

/** A cut of /api/cuts: `proportions` is the JSON schema of each, with the range that is `usual`. */
export interface CutKind extends Titled {
  proportions: JsonObject;
}
