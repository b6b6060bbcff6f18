import { type Frame, parseFrame } from "@culet/protocol/frame";
import { beforeEach, describe, expect, it } from "vitest";
import { bytes } from "../testing/fixtures";
import { FramePlayer, isAfter } from "./frame-player";

const golden = parseFrame(bytes("jpeg.bin"));

function frame(sequence: number): Frame {
  return { ...golden, sequence };
}

describe("order", () => {
  it("follows the sequence", () => {
    expect(isAfter(frame(2), frame(1))).toBe(true);
    expect(isAfter(frame(1), frame(2))).toBe(false);
    expect(isAfter(frame(2), frame(2))).toBe(false);
  });

  it("goes on when the sequence wraps", () => {
    expect(isAfter(frame(0), frame(0xffffffff))).toBe(true);
    expect(isAfter(frame(0xffffffff), frame(0))).toBe(false);
  });

  it("does not ask the clock, which may be set back", () => {
    const [early, late] = [
      { ...frame(1), timestamp: 1000 },
      { ...frame(2), timestamp: 999 },
    ];
    expect(isAfter(late, early)).toBe(true);
    expect(isAfter(early, late)).toBe(false);
  });
});

describe("the player", () => {
  const decoding: { finish: (picture: string | null) => void; fail: (reason: Error) => void; frame: Frame }[] = [];
  const log: string[] = [];
  let player: FramePlayer<string>;

  beforeEach(() => {
    decoding.length = 0;
    log.length = 0;
    player = new FramePlayer<string>({
      decode: (frame) => new Promise((finish, fail) => decoding.push({ finish, fail, frame })),
      show: (picture, { sequence }) => log.push(`show ${sequence} ${picture}`),
      acknowledge: ({ sequence }) => log.push(`ack ${sequence}`),
      fail: ({ sequence }, reason) => log.push(`fail ${sequence} ${reason}`),
    });
  });

  it("acknowledges a frame of which there is no picture, and shows nothing", async () => {
    const done = player.push(golden);
    await Promise.resolve();
    decoding[0]?.finish(null);
    await done;
    expect(log).toEqual(["ack 7"]);
    expect(player.shown).toBe(0);
  });

  it("decodes a frame, then shows it, then acknowledges it", async () => {
    const done = player.push(golden);
    await Promise.resolve();
    expect(decoding[0]?.frame).toBe(golden);
    expect(log).toEqual([]);
    decoding[0]?.finish("picture");
    await done;
    expect(log).toEqual(["show 7 picture", "ack 7"]);
    expect(player.shown).toBe(1);
  });

  it("decodes one after the other, so that none can overtake", async () => {
    const first = player.push(frame(1));
    const second = player.push(frame(2));
    await Promise.resolve();
    expect(decoding).toHaveLength(1);
    decoding[0]?.finish("a");
    await first;
    await Promise.resolve();
    decoding[1]?.finish("b");
    await second;
    expect(log).toEqual(["show 1 a", "ack 1", "show 2 b", "ack 2"]);
  });

  it("drops an older frame, counts it, and acknowledges it all the same", async () => {
    const newer = player.push(frame(5));
    const older = player.push(frame(4));
    await Promise.resolve();
    decoding[0]?.finish("a");
    await Promise.all([newer, older]);
    expect(log).toEqual(["show 5 a", "ack 5", "ack 4"]);
    expect(player.outOfOrder).toBe(1);
    expect(player.shown).toBe(1);
  });

  it("does not show a repeated still twice, and does not call it out of order", async () => {
    const first = player.push(frame(5));
    const again = player.push(frame(5));
    await Promise.resolve();
    decoding[0]?.finish("a");
    await Promise.all([first, again]);
    expect(log).toEqual(["show 5 a", "ack 5", "ack 5"]);
    expect(player.outOfOrder).toBe(0);
  });

  it("goes on after a picture that cannot be decoded", async () => {
    const broken = player.push(frame(1));
    const sound = player.push(frame(2));
    await Promise.resolve();
    decoding[0]?.fail(new Error("not a JPEG"));
    await broken;
    await Promise.resolve();
    decoding[1]?.finish("b");
    await sound;
    expect(log).toEqual(["fail 1 Error: not a JPEG", "ack 1", "show 2 b", "ack 2"]);
    expect(player.shown).toBe(1);
  });
});
