import { Flag, parseFrame } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { FrameHistory, SPAN_SECONDS, STAGES } from "./frame-history";
import { bytes } from "./testing/fixtures";

const moving = parseFrame(bytes("jpeg.bin")); // 0.125 + 31.5 + 1.75 ms, the frontier's error 0.0625
const still = { ...moving, flags: Flag.FINAL, samples: 4, renderMs: 100, error: 0.01 };
const arrival = { time: 5000, decodeMs: 2, roundTripMs: 3 };

test("stages are stacked: each column holds the sum up to it", () => {
  const history = new FrameHistory();
  history.push(moving, arrival);
  const [seconds, ...columns] = history.stageColumns();
  expect(seconds).toEqual([0]);
  expect(columns).toEqual([[0.125], [31.625], [33.375], [34.875], [36.875]]);
  expect(columns.length).toBe(STAGES.length);
  expect(history.latest).toEqual([0.125, 31.5, 1.75, 1.5, 2]);
});

test("times are counted back from the last frame", () => {
  const history = new FrameHistory();
  for (const time of [1000, 1250, 1500]) history.push(moving, { ...arrival, time });
  expect(history.stageColumns()[0]).toEqual([-0.5, -0.25, 0]);
});

test("the frontier's error and an estimated one are different curves", () => {
  const history = new FrameHistory();
  history.push(moving, arrival);
  history.push({ ...still, error: Number.NaN }, { ...arrival, time: 5100 });
  history.push(still, { ...arrival, time: 5200 });
  expect(history.errorColumns().slice(1)).toEqual([
    [0.0625, null, null],
    [null, null, 0.01],
  ]);
});

test("a picture at rest counts by the sample", () => {
  const history = new FrameHistory();
  history.push(still, arrival);
  expect(history.latest[1]).toBe(25);
});

test("frames far apart are not joined", () => {
  const history = new FrameHistory();
  history.push(moving, { ...arrival, time: 1000 });
  history.push(moving, { ...arrival, time: 4000 });
  expect(history.errorColumns()[1]).toEqual([0.0625, null, 0.0625]);
  expect(history.stageColumns()[1]).toEqual([0.125, null, 0.125]);
});

test("what frames usually take leaves out the slowest", () => {
  const history = new FrameHistory();
  expect(history.usual).toBe(0);
  for (let number = 0; number < 20; number += 1) {
    history.push({ ...moving, renderMs: number < 2 ? 1000 : 20 }, { ...arrival, time: 40 * number });
  }
  expect(history.usual).toBeCloseTo(0.125 + 20 + 1.75 + 1.5 + 2);
});

test("what is older than the plots is forgotten", () => {
  const history = new FrameHistory();
  history.push(moving, { ...arrival, time: 0 });
  for (let time = 500; time <= SPAN_SECONDS * 1000 + 500; time += 500) history.push(moving, { ...arrival, time });
  expect(history.stageColumns()[0][0]).toBe(-SPAN_SECONDS);
  history.clear();
  expect(history.stageColumns()[0]).toEqual([]);
});
