/** The gateway's REST interface. Errors are problem documents (RFC 9457). */

import type { JsonObject } from "@culet/protocol/messages";

/** An answer other than 2xx; the message is fit to be shown. */
export class ProblemError extends Error {
  override name = "ProblemError";
  readonly status: number;

  constructor(status: number, message: string) {
    super(message);
    this.status = status;
  }
}

export interface Preset {
  name: string;
  summary: string;
  scene: JsonObject;
}

/** An uploaded mesh: its id for the scene, and sentences about it for the user. */
export interface Mesh {
  id: string;
  findings: string[];
}

async function request(path: string, init?: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, init);
  } catch {
    throw new ProblemError(0, "The server cannot be reached.");
  }
  if (response.ok) return response;
  throw new ProblemError(response.status, problemText(response.status, await response.text()));
}

/** What to tell the user of a refusal: the problem's title and detail, or at least its status. */
export function problemText(status: number, body: string): string {
  try {
    const problem: unknown = JSON.parse(body);
    if (typeof problem === "object" && problem !== null) {
      const { title, detail } = problem as JsonObject;
      const parts = [title, detail].filter((part) => typeof part === "string" && part !== "");
      if (parts.length > 0) return parts.join(": ");
    }
  } catch {
    // a proxy's page, not a problem document
  }
  return `The server answered with status ${status}.`;
}

function post(body: JsonObject): RequestInit {
  return { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) };
}

/** The id of a new session, of the default scene or of a preset. */
export async function createSession(preset?: string): Promise<string> {
  const response = await request("/api/sessions", post(preset === undefined ? {} : { preset }));
  const { id } = (await response.json()) as JsonObject;
  if (typeof id !== "string") throw new ProblemError(response.status, "expected the id of a session, got none");
  return id;
}

/** Ends well if there is such a session; throws ProblemError with status 404 if not. */
export async function findSession(id: string): Promise<void> {
  await request(`/api/sessions/${encodeURIComponent(id)}`);
}

export async function presets(): Promise<Preset[]> {
  const response = await request("/api/presets");
  const { presets } = (await response.json()) as { presets?: Preset[] };
  if (!Array.isArray(presets)) throw new ProblemError(response.status, "expected a list of presets, got none");
  return presets;
}

export async function uploadMesh(file: File): Promise<Mesh> {
  const body = new FormData();
  body.append("file", file);
  return parseMesh((await (await request("/api/meshes", { method: "POST", body })).json()) as JsonObject);
}

/** The gateway's answer to an upload; what it found may stand in a `description`. */
export function parseMesh(answer: JsonObject): Mesh {
  const { id, facets, convex, findings }: JsonObject = { ...(answer.description as JsonObject | undefined), ...answer };
  if (typeof id !== "string") throw new ProblemError(201, "expected the id of a mesh, got none");
  const said = Array.isArray(findings) ? findings.map(String) : [];
  return { id, findings: said.length > 0 ? said : [`${facets} facets, ${convex ? "convex" : "not convex"}.`] };
}

/** The state of that number, rendered at full quality. */
export async function targa(session: string, step: bigint): Promise<Blob> {
  return (await request(`/api/sessions/${session}/frame.tga?step=${step}`)).blob();
}
