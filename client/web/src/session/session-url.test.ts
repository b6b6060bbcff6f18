import { describe, expect, it } from "vitest";
import { sessionAddress, streamUrl, tokenIn, wantedSession, watchAddress, watchedStreamUrl } from "./session-url";

const ID = "0123456789abcdef0123456789abcdef";

describe("the address", () => {
  it("names a session to watch", () => {
    expect(wantedSession(`?session=${ID}`)).toEqual({ kind: "session", id: ID });
  });

  it("names a preset for a new one, or nothing", () => {
    expect(wantedSession("?preset=classic")).toEqual({ kind: "new", preset: "classic" });
    expect(wantedSession("")).toEqual({ kind: "new", preset: undefined });
  });

  it("names a view by what follows its hash, unless it names a session", () => {
    expect(wantedSession("", "#view=1.AB-_")).toEqual({ kind: "view", packed: "1.AB-_" });
    expect(wantedSession(`?session=${ID}`, "#view=1.AB")).toEqual({ kind: "session", id: ID });
  });

  it.each(["", "zz", ID.toUpperCase(), `${ID}0`, "../../etc"])("does not take %j for a session", (id) => {
    expect(wantedSession(`?session=${encodeURIComponent(id)}`)).toEqual({ kind: "invalid", id });
  });

  it("of a session is one that the page reads back", () => {
    expect(wantedSession(sessionAddress(ID))).toEqual({ kind: "session", id: ID });
  });
});

it("has the server's token behind its hash, or none", () => {
  expect(tokenIn("#token=AB-_9")).toBe("AB-_9");
  expect(tokenIn("#view=1.AB")).toBeNull();
  expect(tokenIn("")).toBeNull();
});

it("names a session that is looked at and not steered", () => {
  expect(wantedSession(`?watch=${ID}`)).toEqual({ kind: "watch", id: ID });
  expect(wantedSession("?watch=x")).toEqual({ kind: "invalid", id: "x" });
  expect(wantedSession(watchAddress(ID, { ui: false, rotate: 0, legend: false, background: null }))).toEqual({
    kind: "watch",
    id: ID,
  });
  expect(watchedStreamUrl("https://culet.test/gems/?watch=1")).toBe("wss://culet.test/gems/api/stream");
});

it("streams by wss where the page came by https, and from the folder that the page is in", () => {
  expect(streamUrl("http://localhost:8000/?session=1", ID)).toBe(`ws://localhost:8000/api/sessions/${ID}/stream`);
  expect(streamUrl("https://hub.test/user/ada/proxy/8000/?preset=ruby#x", ID)).toBe(
    `wss://hub.test/user/ada/proxy/8000/api/sessions/${ID}/stream`,
  );
});
