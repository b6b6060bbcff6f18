import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { header } from "../probe";
import { FakeSocket } from "../testing/fake-socket";
import { bytes } from "../testing/fixtures";
import { INITIAL } from "./view-state";
import { Viewer } from "./viewer";

const page = Object.assign(new EventTarget(), { hidden: false });
const problems: string[] = [];
const shown: unknown[] = [];
let viewer: Viewer;

beforeEach(() => {
  page.hidden = false;
  problems.length = 0;
  shown.length = 0;
  FakeSocket.opened = [];
  vi.stubGlobal("WebSocket", FakeSocket);
  vi.stubGlobal("document", page);
  vi.stubGlobal("window", new EventTarget());
  vi.stubGlobal("createImageBitmap", async (blob: Blob) => `${blob.type} of ${blob.size} bytes`);
  viewer = new Viewer("ws://culet.test/stream", {
    show: (picture) => shown.push(picture),
    size: () => ({ width: 640, height: 360 }),
    connection: () => {},
    state: () => {},
    answer: () => undefined,
    lacking: () => problems.push("lacking"),
    refused: ({ code }) => code === "at_the_limit",
    problem: (text) => problems.push(text),
  });
  viewer.stream.open();
});

afterEach(() => {
  viewer.stream.close();
  vi.unstubAllGlobals();
});

function sent(type: string): unknown[] {
  return FakeSocket.last.sent.filter((event) => (event as { type: string }).type === type);
}

describe("a viewer", () => {
  it("says its size and that it is visible, on every connection", () => {
    FakeSocket.last.accept();
    expect(sent("resize")).toEqual([{ type: "resize", width: 640, height: 360 }]);
    expect(sent("visibility")).toEqual([{ type: "visibility", visible: true }]);
  });

  it("says when the page is hidden and when it is back", () => {
    FakeSocket.last.accept();
    for (const hidden of [true, false]) {
      page.hidden = hidden;
      page.dispatchEvent(new Event("visibilitychange"));
    }
    expect(sent("visibility").map((event) => (event as { visible: boolean }).visible)).toEqual([true, false, true]);
  });

  it("knows whether the session was heard of since something was sent", () => {
    FakeSocket.last.accept();
    expect(viewer.untold).toBe(false);
    const state = { type: "state", scene: {}, falling: false } as const;
    FakeSocket.last.say(JSON.stringify({ ...state, revision: 1 }));
    expect(viewer.untold).toBe(false);
    viewer.send({ type: "toggle_mirror" });
    expect(viewer.untold).toBe(true);
    FakeSocket.last.say(JSON.stringify({ ...state, revision: 2 }));
    expect(viewer.untold).toBe(false);
  });

  it("shows a frame, acknowledges it, and keeps its header", async () => {
    FakeSocket.last.accept();
    FakeSocket.last.say(bytes("jpeg.bin"));
    await vi.waitFor(() => expect(sent("ack")).toEqual([{ type: "ack", sequence: 7 }]));
    expect(shown).toEqual(["image/jpeg of 297 bytes"]);
    expect(viewer.player.shown).toBe(1);
    expect(viewer.lastFrame && header(viewer.lastFrame)).toMatchObject({ step: 42, sequence: 7, width: 16, height: 8 });
  });

  it("takes whatever comes after a new engine or connection, though it counts from 1 again", async () => {
    FakeSocket.last.accept();
    const notices = [
      { type: "engine", status: "up" },
      { type: "hello", protocol: 2, session: "", watch: "", viewer: 1 },
    ];
    FakeSocket.last.say(bytes("jpeg.bin"));
    for (const notice of notices) {
      FakeSocket.last.say(bytes("jpeg.bin"));
      FakeSocket.last.say(notice);
      FakeSocket.last.say(bytes("jpeg.bin"));
    }
    await vi.waitFor(() => expect(sent("ack")).toHaveLength(5));
    expect(viewer.player.shown).toBe(3);
  });

  it("keeps what makes its session again if the server loses it, and knows one that ended from a lost one", () => {
    FakeSocket.last.accept();
    FakeSocket.last.say({ type: "snapshot", snapshot: { step: 7 } });
    expect(viewer.snapshot).toEqual({ step: 7 });
    FakeSocket.last.say({ type: "problem", code: "session_lost", message: "no such mesh" });
    expect(problems).toEqual(["lacking", "no such mesh"]);
    expect(viewer.ended).toBe(false);
    FakeSocket.last.say({ type: "problem", code: "session_closed", message: "the session was deleted" });
    expect(viewer.ended).toBe(true);
  });

  it("follows the state, and keeps its own target", () => {
    FakeSocket.last.accept();
    viewer.select("light_2");
    FakeSocket.last.say({ type: "state", revision: 3, scene: { floor: { kind: "mirror" } }, falling: true });
    expect(viewer.state).toMatchObject({
      ...INITIAL,
      scene: viewer.state.scene,
      revision: 3,
      falling: true,
      mirror: true,
      target: "light_2",
    });
  });

  it("opens the stream anew if it has missed something of the scene", () => {
    FakeSocket.last.accept();
    FakeSocket.last.say({ type: "state", revision: 3, scene: {}, falling: false });
    const socket = FakeSocket.last;
    socket.say({ type: "change", revision: 4, since: 3, parts: { walls: { kind: "matte" } }, falling: false });
    expect(viewer.state).toMatchObject({ revision: 4, walls: true });
    socket.say({ type: "change", revision: 9, since: 8, parts: { walls: { kind: "none" } }, falling: false });
    expect(viewer.state).toMatchObject({ revision: 4, walls: true });
    expect(socket.closed).toBe(true);
    expect(viewer.stream.connection.status).toBe("waiting");
  });

  it("passes problems on, its own among them", () => {
    viewer.send({ type: "toggle_fall" });
    FakeSocket.last.accept();
    FakeSocket.last.say({ type: "problem", code: "malformed", message: "yaw: not a number" });
    FakeSocket.last.say({ type: "problem", code: "at_the_limit", message: "told where it was done" });
    expect(problems).toEqual(["Not connected: nothing was sent.", "yaw: not a number"]);
  });
});
