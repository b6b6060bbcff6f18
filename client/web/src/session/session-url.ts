/** What the page's address says about the session, and where its stream is. */

import { packedView } from "../files/view-link";
import { type Embedding, queryOf } from "../picture/embedding";

/** An id as the gateway makes them; anything else in the address is treated as an unknown session. */
const ID = /^[0-9a-f]{32}$/;

export type Wanted =
  | { kind: "session"; id: string }
  | { kind: "view"; packed: string }
  | { kind: "new"; preset: string | undefined }
  | { kind: "invalid"; id: string };

/** By the address' query, and by what follows its hash. */
export function wantedSession(search: string, hash = ""): Wanted {
  const query = new URLSearchParams(search);
  const id = query.get("session");
  if (id !== null) return ID.test(id) ? { kind: "session", id } : { kind: "invalid", id };
  const packed = packedView(hash);
  if (packed !== null) return { kind: "view", packed };
  return { kind: "new", preset: query.get("preset") ?? undefined };
}

/** The address that others may watch the session at. */
export function sessionAddress(id: string, embedding?: Embedding): string {
  return `/?session=${id}${embedding ? queryOf(embedding) : ""}`;
}

export function streamUrl(location: Pick<Location, "protocol" | "host">, id: string): string {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${location.host}/api/sessions/${id}/stream`;
}
