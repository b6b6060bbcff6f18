import { Codec, Flag } from "@culet/protocol/frame";
import { expect, it } from "vitest";
import { ClipFrames, LONGEST_MS, MOST_BYTES } from "./clip-frames";

function frame(step: number, moving = true, bytes = 10) {
  const payload = new Uint8Array(bytes);
  const flags = Flag.KEY | (moving ? Flag.MOVING : 0);
  const size = { width: 640, height: 360 };
  return { step: BigInt(step), flags, ...size, codec: Codec.JPEG as Codec, payload, sequence: step, dependsOn: 0 };
}

it("what was seen when the last seconds began is kept, and nothing before", () => {
  const frames = new ClipFrames();
  for (let second = 0; second <= 25; second++) frames.take(frame(second), 1000 * second);
  const kept = frames.between(Number.NEGATIVE_INFINITY, 25_000);
  expect([kept.at(0)?.time, kept.length]).toEqual([25_000 - LONGEST_MS, LONGEST_MS / 1000 + 1]);
});

it("a better picture of what is at rest takes the place of the one before, and stands since that came", () => {
  const frames = new ClipFrames();
  frames.take(frame(1), 0);
  frames.take(frame(2, false), 100);
  frames.take(frame(2, false, 20), 900);
  expect(
    frames.between(0, 1000).map(({ time, content }) => [time, "payload" in content && content.payload.length]),
  ).toEqual([
    [0, 10],
    [100, 20],
  ]);
  expect(frames.lastTime).toBe(100);
});

it("pictures that move are all kept, though the state is the same", () => {
  const frames = new ClipFrames();
  frames.take(frame(1), 0);
  frames.take(frame(1), 30);
  expect(frames.between(0, 100).length).toBe(2);
});

it("so many bytes are kept, and the newest picture always", () => {
  const frames = new ClipFrames();
  for (let k = 0; k < 8; k++) frames.take(frame(k, true, MOST_BYTES / 4), 10 * k);
  expect(frames.between(0, 1000).map(({ time }) => time)).toEqual([40, 50, 60, 70]);
  frames.take(frame(9, true, 2 * MOST_BYTES), 80);
  expect(frames.between(0, 1000).map(({ time }) => time)).toEqual([80]);
});

it("a stretch begins with what was seen at its start", () => {
  const frames = new ClipFrames();
  for (const time of [0, 100, 200, 300]) frames.take(frame(time), time);
  expect(frames.between(150, 250).map(({ time }) => time)).toEqual([100, 200]);
  expect(frames.between(-50, 50).map(({ time }) => time)).toEqual([0]);
});

it("a frame of video brings along all that it needs, also what came before the last seconds", () => {
  const frames = new ClipFrames();
  for (let k = 0; k < 5; k++) {
    const isKey = k % 4 === 0;
    const flags = Flag.MOVING | (isKey ? Flag.KEY : 0);
    const video = { codec: Codec.H264, flags, sequence: k + 1, dependsOn: isKey ? 0 : k };
    frames.take({ ...frame(k), ...video }, 6000 * k);
  }
  const needed = frames.between(18_000, 24_000).map(({ content }) => {
    const chain: number[] = [];
    let packet = "sequence" in content ? content : null;
    while (packet) {
      chain.push(packet.sequence);
      packet = packet.before;
    }
    return chain;
  });
  expect(needed).toEqual([[4, 3, 2, 1], [5]]);
});

it("a frame of video is not kept without the one that it needs", () => {
  const frames = new ClipFrames();
  frames.take({ ...frame(1), codec: Codec.H264, flags: Flag.MOVING, sequence: 2, dependsOn: 1 }, 0);
  expect(frames.lastTime).toBeNull();
});
