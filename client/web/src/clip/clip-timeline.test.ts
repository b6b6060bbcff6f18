import { expect, it } from "vitest";
import type { ClipFrame } from "./clip-frames";
import { clipSize, timeline } from "./clip-timeline";

function frame(time: number, width = 640, height = 360): ClipFrame {
  return { time, step: 0n, atRest: false, width, height, content: { payload: new Uint8Array(), type: "image/jpeg" } };
}

const times = (frames: ClipFrame[]) => frames.map(({ time }) => time);

it("each picture is shown from when it came until the next one came", () => {
  const frames = [frame(0), frame(90), frame(150)];
  expect(times(timeline(frames, 0, 200))).toEqual([0, 0, 0, 90, 90, 150]);
});

it("of pictures that come faster than a film shows them some are left out", () => {
  expect(times(timeline([frame(0), frame(5), frame(40), frame(60)], 0, 100))).toEqual([0, 5, 60]);
});

it("a stretch that begins after its first picture begins with that", () => {
  expect(times(timeline([frame(0), frame(500)], 450, 550))).toEqual([0, 0, 500]);
});

it("a film has a picture at least", () => {
  expect(times(timeline([frame(7)], 7, 7))).toEqual([7]);
});

it("all pictures get the size of the largest, even and within full HD", () => {
  expect(clipSize([frame(0, 640, 360), frame(1, 1281, 721), frame(2, 320, 180)])).toEqual({ width: 1282, height: 722 });
  expect(clipSize([frame(0, 3840, 2160)])).toEqual({ width: 1920, height: 1080 });
});
