/** Files from and to the user. */

import type { JsonObject } from "@culet/protocol/messages";
import { words } from "../words/words";

export const SCENE_TYPES = ".json,application/json";
/** Of meshes and of cutters' designs. */
export const MESH_TYPES = ".obj,.off,.stl,.ply,.glb,.asc,.gem,.gcs";
export const SKY_TYPES = ".exr,.hdr,.png";

/** Save a blob under a name, as a click on a link would. */
export function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  // Not at once: some browsers read the address only after the click has been handled.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** Let the user choose a file; calls back only if one was chosen. */
export function chooseFile(accept: string, chosen: (file: File) => void): void {
  const input = document.createElement("input");
  input.type = "file";
  input.accept = accept;
  input.onchange = () => {
    const file = input.files?.[0];
    if (file) chosen(file);
  };
  input.click();
}

/** The scene in a file's text; throws Error with words for the user. Its fields are the server's to check. */
export function parseScene(text: string, name: string): JsonObject {
  let data: unknown;
  try {
    data = JSON.parse(text);
  } catch (error) {
    throw new Error(words.files.notJson(name, error instanceof Error ? error.message : String(error)));
  }
  if (typeof data !== "object" || data === null || Array.isArray(data)) {
    throw new Error(words.files.noSceneIn(name, Array.isArray(data) ? words.files.list : String(data)));
  }
  return data as JsonObject;
}
