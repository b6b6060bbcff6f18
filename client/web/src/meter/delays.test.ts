import { Flag, type Frame } from "@culet/protocol/frame";
import type { Reach } from "@culet/protocol/messages";
import { expect, it } from "vitest";
import { Delays } from "./delays";

const ORBIT = { type: "orbit", target: "camera", yaw: 0.1, pitch: 0 } as const;
const ARRIVAL = { time: 1066, decodeMs: 4, roundTripMs: 2 };

function frame(step: number): Frame {
  const made = { step: BigInt(step), flags: Flag.MOVING, simulateMs: 1, renderMs: 30, samples: 2, encodeMs: 5 };
  return made as Frame;
}

function watching(): { delays: Delays; asked: Reach[] } {
  const asked: Reach[] = [];
  const delays = new Delays((question) => asked.push(question));
  delays.on = true;
  return { delays, asked };
}

it("is told of the first frame of the step that was reached, and its stages make it up", () => {
  const { delays, asked } = watching();
  delays.sent(ORBIT, 1000, 1001);
  expect(asked).toEqual([{ type: "reach", number: 1 }]);
  expect(delays.painted(frame(41), ARRIVAL, 1030)).toBeNull();
  expect(delays.heard({ type: "reached", number: 1, step: 42 }, 1006)).toBeNull();
  expect(delays.painted(frame(41), ARRIVAL, 1040)).toBeNull();
  const delay = delays.painted(frame(43), ARRIVAL, 1070);
  expect(delay?.total).toBe(70);
  expect(delay?.stages).toEqual([3, 37, 1, 15, 5, 1, 8]);
  expect(delay?.stages.reduce((sum, stage) => sum + stage)).toBe(70);
  expect(delays.kept).toEqual([delay]);
});

it("finds a frame that came before the answer", () => {
  const { delays } = watching();
  delays.sent(ORBIT, 1000, 1001);
  delays.painted(frame(42), ARRIVAL, 1070);
  delays.painted(frame(43), ARRIVAL, 1103);
  expect(delays.heard({ type: "reached", number: 1, step: 42 }, 1110)?.total).toBe(70);
});

it("follows one input at a time, and another when an answer is lost", () => {
  const { delays, asked } = watching();
  delays.sent(ORBIT, 1000, 1000);
  delays.sent(ORBIT, 1020, 1020);
  expect(asked).toHaveLength(1);
  delays.sent(ORBIT, 7000, 7000);
  expect(asked).toHaveLength(2);
  expect(delays.heard({ type: "reached", number: 1, step: 1 }, 7001)).toBeNull();
});

it("asks nothing while nobody looks, nor of what only time makes visible", () => {
  const { delays, asked } = watching();
  delays.sent({ type: "toggle_fall" }, 1000, 1000);
  delays.on = false;
  delays.sent(ORBIT, 1000, 1000);
  expect(asked).toEqual([]);
});
