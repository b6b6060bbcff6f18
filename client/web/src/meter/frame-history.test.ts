import { Flag, parseFrame } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { bytes } from "../testing/fixtures";
import { FrameHistory, SPAN_SECONDS, STAGES } from "./frame-history";

const moving = parseFrame(bytes("jpeg.bin")); // 0.125 + 31.5 + 1.75 ms, the frontier's error 0.0625
const still = { ...moving, flags: Flag.FINAL, samples: 4, renderMs: 100, error: 0.01 };
const arrival = { time: 5000, decodeMs: 2, roundTripMs: 3 };

test("stages are stacked: each column holds the sum up to it", () => {
  const history = new FrameHistory();
  history.push(moving, arrival);
  const [seconds, ...columns] = history.stageColumns();
  expect(seconds).toEqual([-0.2, 0]);
  expect(columns).toEqual([0.125, 31.625, 33.375, 34.875, 36.875].map((sum) => [sum, sum]));
  expect(columns.length).toBe(STAGES.length);
  expect(history.latest).toEqual([0.125, 31.5, 1.75, 1.5, 2]);
});

test("a frame covers the time in which it was made, counted back from the last one", () => {
  const history = new FrameHistory();
  history.push(moving, { ...arrival, time: 1000 });
  history.push({ ...moving, renderMs: 994.625 }, { ...arrival, time: 2500 }); // 1000 ms with its other stages
  expect(history.stageColumns()[0]).toEqual([-1.7, -1.5, -1, -1, 0]);
  expect(history.stageColumns()[2]).toEqual([31.625, 31.625, null, 994.75, 994.75]);
});

test("frames without a pause between them are joined, however slow they are", () => {
  const history = new FrameHistory();
  for (const time of [3000, 6000, 9000]) history.push({ ...moving, renderMs: 3000 }, { ...arrival, time });
  expect(history.stageColumns().slice(0, 2)).toEqual([
    [-9.005375, -6, -6, -3, -3, 0],
    [0.125, 0.125, 0.125, 0.125, 0.125, 0.125],
  ]);
});

test("the frontier's error and an estimated one are different curves", () => {
  const history = new FrameHistory();
  history.push(moving, arrival);
  history.push({ ...still, error: Number.NaN }, { ...arrival, time: 5100 });
  history.push(still, { ...arrival, time: 5200 });
  expect(history.errorColumns().slice(1)).toEqual([
    [0.0625, 0.0625, null, null, null, null],
    [null, null, null, null, 0.01, 0.01],
  ]);
});

test("a picture at rest counts by the sample", () => {
  const history = new FrameHistory();
  history.push(still, arrival);
  expect(history.latest[1]).toBe(25);
});

test("a picture at rest covers the time of all its samples", () => {
  const history = new FrameHistory();
  history.push({ ...still, renderMs: 994.625 }, arrival);
  expect(history.stageColumns()[0]).toEqual([-1, 0]);
});

test("time in which no frame was made is a gap, and a lone frame has a width", () => {
  const history = new FrameHistory();
  history.push(moving, { ...arrival, time: 1000 });
  history.push(moving, { ...arrival, time: 4000 });
  expect(history.errorColumns().slice(0, 2)).toEqual([
    [-3.2, -3, -0.2, -0.2, 0],
    [0.0625, 0.0625, null, 0.0625, 0.0625],
  ]);
  expect(history.stageColumns()[1]).toEqual([0.125, 0.125, null, 0.125, 0.125]);
});

test("the slowest frame counts, even if it is the only one", () => {
  const history = new FrameHistory();
  expect(history.slowest).toBe(0);
  for (let number = 0; number < 20; number += 1) {
    history.push({ ...moving, renderMs: number === 7 ? 1000 : 20 }, { ...arrival, time: 40 * number });
  }
  expect(history.slowest).toBeCloseTo(0.125 + 1000 + 1.75 + 1.5 + 2);
});

test("what is older than the plots is forgotten", () => {
  const history = new FrameHistory();
  history.push(moving, { ...arrival, time: 0 });
  for (let time = 500; time <= SPAN_SECONDS * 1000 + 500; time += 500) history.push(moving, { ...arrival, time });
  expect(history.stageColumns()[0][0]).toBe(-SPAN_SECONDS);
  history.clear();
  expect(history.stageColumns()[0]).toEqual([]);
});
