/** The gateway's REST interface. Errors are problem documents (RFC 9457). */

import type { JsonObject } from "@culet/protocol/messages";
import { object } from "../json";
import { words } from "../words/words";
import type {
  Cut,
  Cuts,
  DescribedMesh,
  DescribedSky,
  IntegratorDescription,
  Integrators,
  Material,
  Materials,
  MeshAnswer,
  Path,
  Preset,
  Presets,
  Proportions,
  SessionAnswer,
  Skies,
  Sky,
  SkyAnswer,
  TierAngle,
  Tiers,
} from "./answers";
import type { Upload } from "./catalogue";

/** An answer other than 2xx; the message is fit to be shown. */
export class ProblemError extends Error {
  override name = "ProblemError";
  readonly status: number;
  /** The place in the input, such as `stones.0.mesh`. */
  readonly field: string | null;

  constructor(status: number, message: string, field: string | null = null) {
    super(message);
    this.status = status;
    this.field = field;
  }
}

/** Whether it may be gone by itself in a while: nothing answered, or what answered is not ready, or busy. */
export function isPassing({ status }: ProblemError): boolean {
  return [0, 429, 502, 503, 504].includes(status);
}

/** What a picture is saved as. */
export type Format = "png" | "webp" | "tga" | "exr";

/** `path` is beside the page: a proxy may have both in a folder. */
async function request(path: string, init?: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, init);
  } catch {
    throw new ProblemError(0, words.connection.unreachable);
  }
  if (response.ok) return response;
  const body = await response.text();
  throw new ProblemError(response.status, problemText(response.status, body), problemField(body));
}

/** The place in the input that a problem document names. */
function problemField(body: string): string | null {
  try {
    const { field } = object(JSON.parse(body));
    return typeof field === "string" ? field : null;
  } catch {
    return null; // a proxy's page
  }
}

/** What to tell the user of a refusal: the problem's title and detail, or at least its status. */
export function problemText(status: number, body: string): string {
  try {
    const { title, detail } = object(JSON.parse(body));
    const parts = [title, detail].filter((said) => typeof said === "string" && said !== "");
    if (parts.length > 0) return parts.join(": ");
  } catch {
    // a proxy's page, not a problem document
  }
  return words.connection.answered(status);
}

function post(body: JsonObject): RequestInit {
  return { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) };
}

/** Have this browser known by the server's token, which the address that opened the page had. */
export async function signIn(token: string): Promise<void> {
  await request("api/login", { method: "POST", headers: { authorization: `Bearer ${token}` } });
}

/** What a new session shows; nothing: the default scene. */
export type Beginning = { preset?: string } | { scene: JsonObject };

export async function createSession(beginning: Beginning = {}): Promise<{ id: string; scene: JsonObject }> {
  const response = await request("api/sessions", post(beginning));
  const { id, scene } = (await response.json()) as Partial<SessionAnswer>;
  if (typeof id !== "string") throw new ProblemError(response.status, "expected the id of a session, got none");
  return { id, scene: object(scene) };
}

/** What of a session a viewer knows, and can give to a server that has lost it. */
export interface Lost {
  id: string;
  scene: JsonObject;
  snapshot: JsonObject | null;
}

/** Have a session that was lost made again, if no other viewer was faster. */
export async function reopenSession({ id, scene, snapshot }: Lost): Promise<void> {
  await request(`api/sessions/${id}`, { ...post(snapshot ? { scene, snapshot } : { scene }), method: "PUT" });
}

/** Change a session's scene by a merge patch. */
export async function patchSession(id: string, patch: JsonObject): Promise<void> {
  await request(`api/sessions/${encodeURIComponent(id)}`, { ...post(patch), method: "PATCH" });
}

/** What was found in the scene of a session, a sentence each; throws ProblemError with status 404 if there is none. */
export async function findSession(id: string): Promise<{ findings: string[] }> {
  const response = await request(`api/sessions/${encodeURIComponent(id)}`);
  const { findings } = (await response.json()) as Partial<SessionAnswer>;
  return { findings: Array.isArray(findings) ? findings.map(String) : [] };
}

/** The scene as the picture of that step shows it: with its camera, and the stones where they were. */
export async function sceneShown(session: string, step: bigint): Promise<JsonObject> {
  return object(await (await request(`api/sessions/${session}/scene?step=${step}`)).json());
}

/** All that there is of something, under the name that the answer gives it too. */
async function catalogue<Name extends keyof Catalogues>(name: Name): Promise<Catalogues[Name]> {
  const response = await request(`api/${name}`);
  const { [name]: list } = (await response.json()) as Partial<Catalogues>;
  if (!Array.isArray(list)) throw new ProblemError(response.status, `expected a list of ${name}, got none`);
  return list as Catalogues[Name];
}

type Catalogues = Presets & Materials & Cuts & Skies & Integrators;

export function presets(): Promise<Preset[]> {
  return catalogue("presets");
}

export function materials(): Promise<Material[]> {
  return catalogue("materials");
}

export function cuts(): Promise<Cut[]> {
  return catalogue("cuts");
}

export function skies(): Promise<Sky[]> {
  return catalogue("skies");
}

export function integrators(): Promise<IntegratorDescription[]> {
  return catalogue("integrators");
}

/** The grades of a session's stone; with `tilt` its tilt curves too. */
export async function grades(session: string, stone: string, tilt: boolean, signal: AbortSignal): Promise<JsonObject> {
  const query = new URLSearchParams({ stone, tilt: String(tilt), error: "0.2" });
  return object(await (await request(`api/sessions/${session}/grade?${query}`, { signal })).json());
}

/** The proportions of the only stone of a scene. */
export async function proportions(scene: JsonObject): Promise<Proportions> {
  return (await (await request("api/design/proportions", post({ scene }))).json()) as Proportions;
}

/** The sloping tiers of a session's stone; of the tier `reach` with the ends at which its meets are kept. */
export async function tiers(
  session: string,
  stone: string,
  reach: string | null,
  signal: AbortSignal | null = null,
): Promise<TierAngle[]> {
  const query = new URLSearchParams({ stone, ...(reach === null ? {} : { reach }) });
  return ((await (await request(`api/sessions/${session}/tiers?${query}`, { signal })).json()) as Tiers).tiers;
}

/** All that becomes of the light of a pixel of what a session shows. */
export async function path(session: string, pixel: Pixel, signal: AbortSignal): Promise<Path> {
  const query = new URLSearchParams(Object.entries(pixel).map(([name, value]) => [name, String(value)]));
  return (await request(`api/sessions/${session}/path?${query}`, { signal })).json();
}

/** The same of a ray that was told before, through what the session shows now. */
export async function pathAlong(session: string, { origin, direction }: Path, signal: AbortSignal): Promise<Path> {
  const asked = post({ ray: { origin, direction } });
  return (await request(`api/sessions/${session}/path`, { ...asked, signal })).json();
}

/** Of a picture of that size, from its upper left corner. */
export interface Pixel {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Address of the cutting diagram of a session's stone. */
export function diagramAddress(session: string, stone: string): string {
  return `api/sessions/${session}/diagram.svg?${new URLSearchParams({ stone })}`;
}

/** To the server that has the session, or is to have it. */
async function upload<Answer>(session: string, kind: "meshes" | "skies", file: File): Promise<Partial<Answer>> {
  const body = new FormData();
  body.append("file", file);
  return (await (await request(`api/sessions/${session}/${kind}`, { method: "POST", body })).json()) as Partial<Answer>;
}

export async function uploadMesh(session: string, file: File): Promise<Upload> {
  const shape = ({ facets, convex }: Partial<DescribedMesh>) => words.files.facets(String(facets), Boolean(convex));
  return parseUpload(await upload<MeshAnswer>(session, "meshes", file), shape);
}

export async function uploadSky(session: string, file: File): Promise<Upload> {
  const shape = ({ width, height }: Partial<DescribedSky>) => words.files.pixels(String(width), String(height));
  return parseUpload(await upload<SkyAnswer>(session, "skies", file), shape);
}

/** The gateway's answer to an upload, and what to say of one in which nothing was found. */
function parseUpload<Description extends { findings: string[] }>(
  { id, description }: { id?: string; description?: Description },
  otherwise: (description: Partial<Description>) => string,
): Upload {
  if (typeof id !== "string") throw new ProblemError(201, "expected the id of an upload, got none");
  const said = Array.isArray(description?.findings) ? description.findings.map(String) : [];
  return { id, findings: said.length > 0 ? said : [otherwise(description ?? {})] };
}

/** A picture of what a session shows, one of its stones of another design. */
export interface BesideRequest {
  stone: string;
  design: JsonObject;
  step: bigint;
  width: number;
  height: number;
}

/** With `samples` of each pixel, or as many as the live picture gets at rest. */
export async function beside(
  session: string,
  { step, ...asked }: BesideRequest,
  samples: number | null,
  signal: AbortSignal,
): Promise<Blob> {
  const body = post({ ...asked, step: Number(step), ...(samples === null ? {} : { samples }) });
  return (await request(`api/sessions/${session}/beside`, { ...body, signal })).blob();
}

/** The state of that number, rendered at full quality. */
export async function picture(session: string, step: bigint, format: Format): Promise<Blob> {
  return (await request(`api/sessions/${session}/frame.${format}?step=${step}`)).blob();
}
