/** What the server offers to choose from, and what the page makes of an upload. */

import type { Material, Sky } from "./answers";

export type { Cut as CutKind, Preset } from "./answers";

/** Something that a scene can name, of which the name is not what people call it. */
export type Titled = Pick<Sky, "name" | "title" | "summary">;

export type MaterialChoice = Titled & Pick<Material, "coloured"> & { indices: Readonly<Material["indices"]> };

/** An uploaded mesh or sky: its id for the scene, and sentences about it for the user. */
export interface Upload {
  id: string;
  findings: string[];
}
