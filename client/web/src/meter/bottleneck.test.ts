import { Flag } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { BottleneckMeter } from "./bottleneck";

const RATE = 30;

interface Play {
  decodeMs?: number;
  flags?: number;
  /** Of so many frames made, one comes. */
  every?: number;
  samples?: number;
}

/** What is said after a second of such frames. */
function after({ decodeMs = 5, flags = Flag.MOVING, every = 1, samples = 1 }: Play): string | null {
  const meter = new BottleneckMeter();
  for (let frame = 0; frame < RATE; frame += 1) {
    meter.shown({ flags, sequence: 0xfffffff0 + frame * every, samples }, (frame * 1000) / RATE, decodeMs);
  }
  return meter.at(1000);
}

test("frames that all come, as good as they are made, wait for rendering", () => {
  expect(after({})).toBe("rendering");
});

test("frames that were made smaller for the link, or did not come, wait for the network", () => {
  expect(after({ flags: Flag.MOVING | Flag.THRIFTY })).toBe("network");
  expect(after({ every: 2 })).toBe("network");
});

test("frames that take this browser all its time wait for the browser, whatever else is said of them", () => {
  expect(after({ decodeMs: 30, flags: Flag.MOVING | Flag.THRIFTY })).toBe("browser");
  expect(after({ decodeMs: 20 })).toBe("rendering");
});

test("a picture at rest waits for nothing, nor does one that is long past", () => {
  expect(after({ samples: 4 })).toBeNull();
  const meter = new BottleneckMeter();
  meter.shown({ flags: 0, sequence: 1, samples: 1 }, 0, 5);
  expect(meter.at(1)).toBeNull();
  meter.shown({ flags: 0, sequence: 2, samples: 1 }, 30, 5);
  expect(meter.at(40)).toBe("rendering");
  expect(meter.at(5000)).toBeNull();
});
