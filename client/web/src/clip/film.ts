/** Pictures made into a file that plays where people are; what makes it is loaded when the first clip is made. */

import { words } from "../words/words";
import type { ClipFrame } from "./clip-frames";

export interface Film {
  file: Blob;
  /** Of its name, without the dot. */
  ending: "mp4" | "webm";
}

export interface Making {
  /** The part that is done, 0 to 1. */
  progress: (part: number) => void;
  /** Throws its reason once nobody wants the film any more. */
  signal: AbortSignal;
}

/** The film of these pictures, RATE of them a second; throws Error with words for the user if this browser makes none. */
export async function filmOf(timeline: readonly ClipFrame[], making: Making): Promise<Film> {
  // Browsers give their encoders only to pages that came by https, or from this machine; recorders they give to all.
  if (typeof VideoEncoder !== "undefined") {
    const { encodedFilm } = await import("./encoded-film");
    const film = await encodedFilm(timeline, making);
    if (film) return film;
  }
  if (typeof MediaRecorder === "undefined") throw new Error(words.clip.unable);
  const { recordedFilm } = await import("./recorded-film");
  return recordedFilm(timeline, making);
}

export function filmIn(bytes: ArrayBuffer | null, ending: Film["ending"]): Film {
  if (!bytes) throw new Error("expected the bytes of a film, got none");
  return { file: new Blob([bytes], { type: `video/${ending}` }), ending };
}
