import { afterEach, expect, test, vi } from "vitest";
import { bitmapOf } from "../video/bitmap";
import { PacketDecoder } from "../video/packet-decoder";
import type { ClipFrame, Packet } from "./clip-frames";
import { Easel } from "./easel";

vi.mock("../video/bitmap", () => ({ bitmapOf: vi.fn() }));

afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

test("of the pictures that are shown none is kept once another one comes, nor once the easel is closed", async () => {
  const context = { fillRect: vi.fn(), drawImage: vi.fn() };
  const canvas = { width: 0, height: 0, getContext: () => context };
  vi.stubGlobal("document", { createElement: () => canvas });
  let open = 0;
  vi.stubGlobal("createImageBitmap", async () => {
    open += 1;
    return { width: 16, height: 16, close: () => (open -= 1) };
  });
  const frame = {
    time: 0,
    step: 1n,
    atRest: true,
    width: 16,
    height: 16,
    content: { payload: new Uint8Array(1), type: "image/png" },
  };
  const easel = new Easel({ width: 16, height: 16 });
  for (const step of [1n, 2n]) await easel.show({ ...frame, step });
  expect(open).toBe(1);
  easel.close();
  expect(open).toBe(0);
  expect(context.drawImage).toHaveBeenCalledTimes(2);
});

test("a packet that fails once is decoded again from its key frame, and one that fails always leaves what was shown", async () => {
  const drawn: unknown[] = [];
  const context = { fillRect: vi.fn(), drawImage: (picture: unknown) => drawn.push(picture) };
  vi.stubGlobal("document", { createElement: () => ({ width: 0, height: 0, getContext: () => context }) });
  vi.mocked(bitmapOf).mockImplementation((picture) => picture as unknown as ReturnType<typeof bitmapOf>);
  const asked: number[] = [];
  const fails = new Map([
    [2, 1],
    [4, 9],
  ]);
  vi.spyOn(PacketDecoder.prototype, "decode").mockImplementation(async (packet) => {
    const { sequence } = packet as Packet;
    asked.push(sequence);
    const left = fails.get(sequence) ?? 0;
    fails.set(sequence, left - 1);
    if (left > 0) throw new Error("the decoder is gone");
    return { sequence, width: 16, height: 16, close: () => undefined } as unknown as VideoFrame;
  });
  const size = { width: 16, height: 16 };
  const data = new Uint8Array(1);
  let before: Packet | null = null;
  const frames = [1, 2, 3, 4, 5, 6].map((sequence): ClipFrame => {
    before = { codec: "h264", isKey: sequence === 1 || sequence === 6, ...size, data, sequence, before };
    if (before.isKey) before.before = null;
    return { time: 0, step: BigInt(sequence), atRest: false, ...size, content: before };
  });
  const easel = new Easel(size);
  for (const frame of frames) await easel.show(frame);
  expect(drawn.map((picture) => (picture as Packet).sequence)).toEqual([1, 2, 3, 3, 3, 6]);
  expect(asked).toEqual([1, 2, 1, 2, 3, 4, 1, 2, 3, 4, 6]);
});

test("a clip of which nothing can be decoded says so", async () => {
  vi.stubGlobal("document", { createElement: () => ({ width: 0, height: 0, getContext: () => ({}) }) });
  vi.spyOn(PacketDecoder.prototype, "decode").mockRejectedValue(new Error("the decoder is gone"));
  const size = { width: 16, height: 16 };
  const content: Packet = { codec: "h264", isKey: true, ...size, data: new Uint8Array(1), sequence: 1, before: null };
  const easel = new Easel(size);
  await expect(easel.show({ time: 0, step: 1n, atRest: false, ...size, content })).rejects.toThrow("decodes");
});
