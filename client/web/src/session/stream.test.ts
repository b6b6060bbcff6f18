import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { FakeSocket } from "../testing/fake-socket";
import { bytes } from "../testing/fixtures";
import { type Connection, LOST_PINGS, PAUSES, PING_MS, Stream } from "./stream";

const URL = "ws://culet.test/api/sessions/0/stream";
const connections: Connection[] = [];
const heard: unknown[] = [];
const listener = {
  connection: (connection: Connection) => connections.push(connection),
  notice: (notice: unknown) => heard.push(notice),
  frame: (frame: { sequence: number }) => heard.push(frame.sequence),
  malformed: (error: Error) => heard.push(error.name),
};
let stream: Stream;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("WebSocket", FakeSocket);
  FakeSocket.opened = [];
  connections.length = 0;
  heard.length = 0;
  stream = new Stream(URL, listener, () => 1);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function open(): FakeSocket {
  stream.open();
  FakeSocket.last.accept();
  return FakeSocket.last;
}

describe("opening", () => {
  it("asks for this version of the protocol and for array buffers", () => {
    const socket = open();
    expect([socket.url, socket.protocols, socket.binaryType]).toEqual([URL, ["culet.v2"], "arraybuffer"]);
    expect(connections.map(({ status }) => status)).toEqual(["connecting", "open"]);
  });

  it("says by a subprotocol which session it watches, where the address does not", () => {
    const id = "0123456789abcdef0123456789abcdef";
    new Stream("ws://culet.test/api/stream", listener, () => 1, id).open();
    expect(FakeSocket.last.protocols).toEqual(["culet.v2", `culet.watch.${id}`]);
  });

  it("sends nothing before the socket is open, and says so", () => {
    stream.open();
    expect(stream.send({ type: "toggle_fall" })).toBe(false);
    FakeSocket.last.accept();
    expect(stream.send({ type: "toggle_fall" })).toBe(true);
    expect(FakeSocket.last.sent).toContainEqual({ type: "toggle_fall" });
  });
});

describe("messages", () => {
  it("are notices if text and frames if binary", () => {
    const socket = open();
    socket.say({ type: "viewers", count: 3 });
    socket.say(bytes("jpeg.bin"));
    expect(heard).toEqual([{ type: "viewers", count: 3 }, 7]);
  });

  it("that are neither are reported, and the stream goes on", () => {
    const socket = open();
    socket.say("{");
    socket.say(bytes("wrong_magic.bin"));
    socket.say({ type: "from_the_future" });
    socket.say({ type: "viewers", count: 1 });
    expect(heard).toEqual(["NoticeError", "FrameError", { type: "viewers", count: 1 }]);
    expect(stream.connection.status).toBe("open");
  });
});

describe("a lost connection", () => {
  it("is tried again after growing pauses", () => {
    open().drop(1006);
    for (const pause of [...PAUSES, PAUSES.at(-1) ?? 0]) {
      expect(stream.connection).toEqual({ status: "waiting", delay: pause });
      vi.advanceTimersByTime(pause - 1);
      expect(stream.connection.status).toBe("waiting");
      vi.advanceTimersByTime(1);
      expect(stream.connection.status).toBe("connecting");
      FakeSocket.last.drop(1006);
    }
  });

  it("starts with the short pause again once it was open", () => {
    open().drop(1006);
    vi.advanceTimersByTime(PAUSES[0] ?? 0);
    FakeSocket.last.drop(1006);
    expect(stream.connection).toEqual({ status: "waiting", delay: PAUSES[1] });
    vi.advanceTimersByTime(PAUSES[1] ?? 0);
    FakeSocket.last.accept();
    FakeSocket.last.drop(1012);
    expect(stream.connection).toEqual({ status: "waiting", delay: PAUSES[0] });
  });

  it("is tried at once when the network is back, and only once", () => {
    open().drop(1006);
    stream.retryNow();
    expect(FakeSocket.opened).toHaveLength(2);
    stream.retryNow();
    vi.advanceTimersByTime(60_000);
    expect(FakeSocket.opened).toHaveLength(2);
  });

  it("is not tried again after a final code, which is told with its reason", () => {
    open().drop(4404, "the session has ended");
    vi.advanceTimersByTime(60_000);
    expect(FakeSocket.opened).toHaveLength(1);
    expect(connections.at(-1)).toEqual({ status: "closed", code: 4404, reason: "the session has ended" });
  });

  it("cannot speak any more", () => {
    const old = open();
    old.drop(1006);
    vi.advanceTimersByTime(PAUSES[0] ?? 0);
    FakeSocket.last.accept();
    old.say({ type: "viewers", count: 9 });
    old.drop(4404);
    expect(heard).toEqual([]);
    expect(stream.connection.status).toBe("open");
  });
});

describe("pings", () => {
  it("measure the way there and back", () => {
    const socket = open();
    const ping = socket.sent.find((event) => (event as { type: string }).type === "ping") as { time: number };
    vi.advanceTimersByTime(40);
    socket.say({ type: "pong", time: ping.time });
    expect(stream.latency.milliseconds).toBeCloseTo(40, 6);
  });

  it("that nobody answers end the connection", () => {
    const socket = open();
    vi.advanceTimersByTime(PING_MS * (LOST_PINGS - 1));
    expect(stream.connection.status).toBe("open");
    vi.advanceTimersByTime(PING_MS);
    expect(socket.closed).toBe(true);
    expect(stream.connection.status).toBe("waiting");
  });

  it("that are answered keep it", () => {
    const socket = open();
    for (let second = 0; second < 60; second += 1) {
      vi.advanceTimersByTime(PING_MS);
      socket.say({ type: "pong", time: performance.now() });
    }
    expect(stream.connection.status).toBe("open");
    expect(FakeSocket.opened).toHaveLength(1);
  });
});

describe("a slow line", () => {
  it("is kept while anything comes of it, though pongs are late", () => {
    const socket = open();
    for (let frame = 0; frame < 10; frame += 1) {
      vi.advanceTimersByTime(PING_MS * (LOST_PINGS - 2));
      socket.say(bytes("jpeg.bin"));
    }
    expect(stream.connection.status).toBe("open");
    expect(FakeSocket.opened).toHaveLength(1);
  });
});

it("closes for good when the page says so", () => {
  const socket = open();
  stream.close(4404, "no such session");
  expect(socket.closed).toBe(true);
  vi.advanceTimersByTime(60_000);
  expect(FakeSocket.opened).toHaveLength(1);
  expect(stream.connection).toEqual({ status: "closed", code: 4404, reason: "no such session" });
});
