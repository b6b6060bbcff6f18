import { Codec, Flag, parseFrame } from "@culet/protocol/frame";
import { expect, it, test } from "vitest";
import { FrameRate } from "../session/frame-rate";
import { bytes } from "../testing/fixtures";
import { briefText, milliseconds, significant, statusText } from "./status-text";

const frame = parseFrame(bytes("jpeg.bin")); // 0.125 + 31.5 + 1.75 ms

test("the status line says rate, times, size, samples and viewers", () => {
  expect(statusText({ framesPerSecond: 24, frame, roundTripMs: 3.25, viewers: 2, connected: true })).toBe(
    "24.0 frames/s \u00b7 server 33.4 ms (simulate 0.13, render 31.5, encode 1.75) \u00b7 round trip 3.25 ms" +
      " \u00b7 frontier's error 0.063 \u00b7 caustics lack at most 13 % \u00b7 16\u00d78 JPEG \u00b7 1 sample \u00b7 2 viewers",
  );
});

test("what keeps moving frames from being more or better ones is named", () => {
  const status = { framesPerSecond: 12, frame, roundTripMs: null, viewers: 1, connected: true };
  expect(statusText({ ...status, bottleneck: "network" })).toMatch(
    /^12\.0 frames\/s \u00b7 limited by the network \u00b7 /,
  );
  expect(statusText({ ...status, bottleneck: "browser" })).toContain(" \u00b7 limited by this browser \u00b7 ");
  expect(statusText({ ...status, bottleneck: null })).not.toContain("limited");
});

test("the first picture at rest is being refined, also if the next takes long", () => {
  const status = { framesPerSecond: 0, roundTripMs: null, viewers: 1, connected: true };
  const first = { ...frame, flags: 0, samples: 1 };
  expect(statusText({ ...status, frame: first })).toMatch(/^refining/);
  expect(briefText({ ...status, frame: first })).toBe("refining");
  expect(briefText({ ...status, framesPerSecond: 30, frame: first })).toBe("30.0 frames/s"); // while the camera moves
});

test("a finished picture is called still, one that is late is not", () => {
  const status = { framesPerSecond: 0, roundTripMs: null, viewers: 1, connected: true };
  expect(statusText({ ...status, frame: { ...frame, flags: Flag.FINAL, samples: 64 } })).toMatch(/^still picture/);
  expect(statusText({ ...status, frame: { ...frame, flags: Flag.MOVING } })).toMatch(/^0\.0 frames\/s/);
});

test("a stone that falls slower than in real time is said to", () => {
  const status = { framesPerSecond: 7, roundTripMs: null, viewers: 1, connected: true };
  expect(statusText({ ...status, frame: { ...frame, flags: Flag.MOVING | Flag.SLOW } })).toContain(
    " \u00b7 slow motion \u00b7 ",
  );
  expect(statusText({ ...status, frame: { ...frame, flags: Flag.MOVING } })).not.toContain("slow");
});

test("a picture at rest tells what a sample takes, not the sum over all of them", () => {
  const refining = { ...frame, flags: 0, samples: 4, renderMs: 100, error: 0.063 };
  const status = { framesPerSecond: 1.5, roundTripMs: null, viewers: 1, connected: true };
  expect(statusText({ ...status, frame: refining })).toBe(
    "refining \u00b7 render 25.0 ms a sample \u00b7 error 0.063 \u00b7 caustics lack at most 13 % \u00b7 16\u00d78 JPEG \u00b7 4 samples \u00b7 1 viewer",
  );
  const finished = { ...refining, flags: Flag.FINAL };
  expect(statusText({ ...status, frame: finished })).toMatch(/^still picture \u00b7 render 25\.0 ms/);
});

test("a picture at rest tells how good it is as shown, and whether that is what it was to be", () => {
  const status = { framesPerSecond: 0, roundTripMs: null, viewers: 1, connected: true };
  const resting = { ...frame, flags: 0, samples: 16, error: 0.03, shownError: 0.0071, restError: 0.004 };
  const text = (changes: Partial<typeof resting>) => statusText({ ...status, frame: { ...resting, ...changes } });
  expect(text({})).toContain("refining \u00b7");
  expect(text({})).toContain(" \u00b7 error 0.0071 as shown, to be 0.004 \u00b7 ");
  expect(text({ flags: Flag.FINAL })).toContain(" \u00b7 error 0.0071 as shown, 0.004 not reached \u00b7 ");
  expect(text({ flags: Flag.FINAL, shownError: 0.00398 })).toContain(" \u00b7 error 0.004 as shown \u00b7 ");
  expect(text({ restError: Number.NaN })).toContain(" \u00b7 error 0.0071 as shown \u00b7 ");
});

test("in short it tells only how fast the picture moves, or that it is finished, and who else looks", () => {
  const status = { framesPerSecond: 29.97, roundTripMs: 3, viewers: 1, connected: true };
  const resting = { ...frame, flags: 0, samples: 16 };
  expect(briefText({ ...status, frame: { ...frame, flags: Flag.MOVING, samples: 1 } })).toBe("30.0 frames/s");
  expect(briefText({ ...status, frame: { ...frame, flags: Flag.MOVING | Flag.SLOW, samples: 1 } })).toMatch(
    /slow motion$/,
  );
  expect(briefText({ ...status, frame: resting })).toBe("refining");
  expect(briefText({ ...status, frame: { ...resting, flags: Flag.FINAL } })).toBe("still picture");
  expect(briefText({ ...status, frame: resting, viewers: 3 })).toBe("refining \u00b7 3 viewers");
  expect(briefText({ ...status, frame: null })).toBe("waiting for the first picture");
  expect(briefText({ ...status, frame: resting, connected: false })).toBe("not connected");
});

test("what is known of the error is said", () => {
  const status = { framesPerSecond: 0, roundTripMs: null, viewers: 1, connected: true };
  const still = { ...frame, flags: 0, error: 0.01234 };
  expect(statusText({ ...status, frame: still })).toContain(" \u00b7 error 0.012 \u00b7 ");
  expect(statusText({ ...status, frame: { ...still, error: Number.NaN } })).not.toContain("error");
});

test("what floor and walls lack of the stones' light is said where they show any", () => {
  const status = { framesPerSecond: 0, roundTripMs: null, viewers: 1, connected: true };
  const dark = { ...frame, flags: Flag.SHADOWS_ONLY, lightCut: 1 };
  expect(statusText({ ...status, frame: dark })).toContain(" \u00b7 shadows without caustics \u00b7 ");
  for (const lightCut of [Number.NaN, 0]) {
    expect(statusText({ ...status, frame: { ...frame, lightCut } })).not.toContain("caustics");
  }
});

test.each([
  [0, "0"],
  [0.5, "0.5"],
  [0.00026, "0.00026"],
  [0.0000123, "1.2e-5"],
])("an error of %d is written %s", (value, text) => {
  expect(significant(value)).toBe(text);
});

test("before the first frame it says that it waits", () => {
  expect(statusText({ framesPerSecond: 0, frame: null, roundTripMs: null, viewers: 1, connected: true })).toBe(
    "waiting for the first picture \u00b7 1 viewer",
  );
});

test.each([
  [0, "0.00"],
  [1.756, "1.76"],
  [31.46, "31.5"],
  [2048.5, "2049"],
])("%d ms is written %s", (value, text) => {
  expect(milliseconds(value)).toBe(text);
});

it("counts frames over the last two seconds", () => {
  const rate = new FrameRate();
  for (let time = 0; time < 5000; time += 40) rate.shown(time);
  expect(rate.perSecond(4999)).toBe(25);
  expect(rate.perSecond(6000)).toBe(12); // the 24 frames after 4000 ms
  expect(rate.perSecond(9000)).toBe(0);
});

test("what is video is named", () => {
  const status = { framesPerSecond: 24, roundTripMs: null, viewers: 1, connected: true };
  expect(statusText({ ...status, frame: { ...frame, codec: Codec.H264 } })).toContain(
    " \u00b7 16\u00d78 H.264 \u00b7 ",
  );
});
