/** Files that are dropped on the page: opened by their endings. A browser left alone would leave the page for the file. */

import { words } from "../words/words";
import { MESH_TYPES, SCENE_TYPES, SKY_TYPES } from "./files";

export type Opens = Record<"scene" | "mesh" | "sky", (file: File) => void>;

const ENDINGS: Record<keyof Opens, string[]> = {
  scene: SCENE_TYPES.split(","),
  mesh: MESH_TYPES.split(","),
  sky: SKY_TYPES.split(","),
};

/** What a file of that name is opened as, or null. */
export function kindOf(name: string): keyof Opens | null {
  const ending = name.slice(name.lastIndexOf(".")).toLowerCase();
  const kinds: (keyof Opens)[] = ["scene", "mesh", "sky"];
  return kinds.find((kind) => ENDINGS[kind].includes(ending)) ?? null;
}

/** Open what is dropped, each file in its turn; `refuse` is told of one that is nothing to open. */
export function listenToDrops(target: Pick<Window, "addEventListener">, opens: Opens, refuse: (text: string) => void) {
  const ofFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  target.addEventListener("dragover", (event) => {
    if (!event.dataTransfer || !ofFiles(event)) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "copy";
  });
  target.addEventListener("drop", (event) => {
    if (!event.dataTransfer || !ofFiles(event)) return;
    event.preventDefault();
    for (const file of event.dataTransfer.files) {
      const kind = kindOf(file.name);
      if (kind) opens[kind](file);
      else refuse(words.files.notToOpen(file.name, said("scene"), said("mesh"), said("sky")));
    }
  });
}

function said(kind: keyof Opens): string {
  return ENDINGS[kind].filter((ending) => ending.startsWith(".")).join(" ");
}
