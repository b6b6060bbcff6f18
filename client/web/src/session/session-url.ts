/** What the page's address says about the session, and where its stream is. */

import { packedView } from "../files/view-link";
import { type Embedding, queryOf } from "../picture/embedding";

/** An id as the gateway makes them; anything else in the address is treated as an unknown session. */
const ID = /^[0-9a-f]{32}$/;

export type WantedSession =
  | { kind: "session"; id: string }
  /** By its watch id, which lets look and not steer. */
  | { kind: "watch"; id: string }
  | { kind: "view"; packed: string }
  | { kind: "new"; preset: string | undefined }
  | { kind: "invalid"; id: string };

/** By the address' query, and by what follows its hash. */
export function wantedSession(search: string, hash = ""): WantedSession {
  const query = new URLSearchParams(search);
  for (const kind of ["session", "watch"] as const) {
    const id = query.get(kind);
    if (id !== null) return ID.test(id) ? { kind, id } : { kind: "invalid", id };
  }
  const packed = packedView(hash);
  if (packed !== null) return { kind: "view", packed };
  return { kind: "new", preset: query.get("preset") ?? undefined };
}

/** The server's token, if the page was opened with it. */
export function tokenIn(hash: string): string | null {
  return new URLSearchParams(hash.slice(1)).get("token");
}

/** The address that others may watch and steer the session at, beside the page's. */
export function sessionAddress(id: string, embedding?: Embedding): string {
  return `?session=${id}${embedding ? queryOf(embedding) : ""}`;
}

/** The address that others may watch it at, by its watch id. */
export function watchAddress(watch: string, embedding?: Embedding): string {
  return `?watch=${watch}${embedding ? queryOf(embedding) : ""}`;
}

export function streamUrl(page: string, id: string): string {
  return beside(page, `api/sessions/${id}/stream`);
}

/** Of a session that is watched: its watch id is no part of it, but one of the subprotocols that are offered. */
export function watchedStreamUrl(page: string): string {
  return beside(page, "api/stream");
}

/** A stream's address, by the page's own: a proxy may have both in a folder. */
function beside(page: string, path: string): string {
  const address = new URL(path, page);
  address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
  return address.href;
}
