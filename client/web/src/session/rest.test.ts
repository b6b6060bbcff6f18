import { afterEach, describe, expect, it, vi } from "vitest";
import {
  createSession,
  findSession,
  isPassing,
  materials,
  ProblemError,
  patchSession,
  picture,
  problemText,
  uploadMesh,
  uploadSky,
} from "./rest";

afterEach(() => vi.unstubAllGlobals());

const SESSION = "ab".repeat(16);

/** What fetch was called with, and what it answers. */
function answering(status: number, body: unknown) {
  const calls: { path: string; init: RequestInit | undefined }[] = [];
  vi.stubGlobal("fetch", async (path: string, init?: RequestInit) => {
    calls.push({ path, init });
    return new Response(typeof body === "string" ? body : JSON.stringify(body), { status });
  });
  return calls;
}

it("patches a session", async () => {
  const calls = answering(200, {});
  await patchSession("abc", { floor: { kind: "none" } });
  expect(calls[0]?.path).toBe("api/sessions/abc");
  expect(calls[0]?.init).toMatchObject({ method: "PATCH", body: '{"floor":{"kind":"none"}}' });
});

describe("a new session", () => {
  it("is of the default scene, or of a preset", async () => {
    const calls = answering(201, { id: "abc", scene: {} });
    expect(await createSession()).toEqual({ id: "abc", scene: {} });
    await createSession({ preset: "classic" });
    expect(calls.map(({ path }) => path)).toEqual(["api/sessions", "api/sessions"]);
    expect(calls.map(({ init }) => init?.body)).toEqual(["{}", '{"preset":"classic"}']);
    expect(calls[0]?.init?.method).toBe("POST");
  });

  it("that is refused says why", async () => {
    answering(429, { title: "at the limit", detail: "64 sessions are open; try again later", status: 429 });
    await expect(createSession()).rejects.toThrow("at the limit: 64 sessions are open; try again later");
  });

  it("without an id is an error", async () => {
    answering(201, {});
    await expect(createSession()).rejects.toThrow(ProblemError);
  });
});

it("tells an unknown session by its status", async () => {
  answering(404, { title: "not found", detail: "no such session" });
  await expect(findSession("abc")).rejects.toMatchObject({ status: 404 });
});

it("reads what was found in the scene of a session, which older servers do not say", async () => {
  answering(200, { id: "abc", findings: ["two stones overlap"] });
  expect(await findSession("abc")).toEqual({ findings: ["two stones overlap"] });
  answering(200, { id: "abc" });
  expect(await findSession("abc")).toEqual({ findings: [] });
});

it("says that the server cannot be reached", async () => {
  vi.stubGlobal("fetch", () => Promise.reject(new TypeError("failed to fetch")));
  await expect(findSession("abc")).rejects.toMatchObject({ status: 0, message: "The server cannot be reached." });
});

it("uploads a mesh as a form with one file", async () => {
  const findings = ["2 duplicate vertices merged."];
  const calls = answering(201, { id: "m", description: { facets: 6, convex: true, findings } });
  const mesh = await uploadMesh(SESSION, new File(["OFF"], "cube.off"));
  expect(mesh).toEqual({ id: "m", findings });
  const form = calls[0]?.init?.body as FormData;
  expect((form.get("file") as File).name).toBe("cube.off");
});

it("says at least the shape of an upload in which nothing was found", async () => {
  answering(201, { id: "m", description: { facets: 6, convex: false, findings: [] } });
  expect((await uploadMesh(SESSION, new File(["OFF"], "cube.off"))).findings).toEqual(["6 facets, not convex."]);
  const calls = answering(201, { id: "s", description: { width: 16, height: 8, findings: [] } });
  expect(await uploadSky(SESSION, new File(["#?"], "sky.hdr"))).toEqual({ id: "s", findings: ["16 \u00d7 8 pixels."] });
  expect(calls[0]?.path).toBe(`api/sessions/${SESSION}/skies`);
});

it("refuses an upload's answer without an id", async () => {
  answering(201, { description: { facets: 6 } });
  await expect(uploadMesh(SESSION, new File(["OFF"], "cube.off"))).rejects.toThrow("expected the id of an upload");
});

it("lists what a scene can name", async () => {
  const calls = answering(200, { nanometres: [], materials: [{ name: "ruby", summary: "red" }] });
  expect(await materials()).toEqual([{ name: "ruby", summary: "red" }]);
  expect(calls[0]?.path).toBe("api/materials");
  answering(200, {});
  await expect(materials()).rejects.toThrow("expected a list of materials");
});

it("asks for a step that a double cannot hold by all its digits", async () => {
  const calls = answering(200, "tga");
  await picture("abc", 2n ** 53n + 1n, "png");
  expect(calls[0]?.path).toBe("api/sessions/abc/frame.png?step=9007199254740993");
});

it("tells what passes by itself from what does not", () => {
  const passing = [0, 404, 422, 429, 500, 503].filter((status) => isPassing(new ProblemError(status, "")));
  expect(passing).toEqual([0, 429, 503]);
});

describe("a refusal in words", () => {
  it("is the problem's title and detail", () => {
    expect(problemText(422, '{"title": "unusable mesh", "detail": "it is open"}')).toBe("unusable mesh: it is open");
    expect(problemText(422, '{"title": "unusable mesh"}')).toBe("unusable mesh");
  });

  it.each(["<html>Bad Gateway</html>", "null", "{}", ""])("falls back to the status for %j", (body) => {
    expect(problemText(502, body)).toBe("The server answered with status 502.");
  });
});
