import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { LATEST_MS, PacketDecoder, type VideoPacket } from "./packet-decoder";
import { TRIAL_FRAMES } from "./trial-frames";

const KEY = Uint8Array.from(atob(TRIAL_FRAMES.h264), (byte) => byte.charCodeAt(0));

class FakeDecoder {
  static made: FakeDecoder[] = [];
  static behaviour: "decodes" | "holds back" | "fails" = "decodes";
  state = "unconfigured";
  config: VideoDecoderConfig | null = null;
  private readonly init: VideoDecoderInit;

  constructor(init: VideoDecoderInit) {
    this.init = init;
    FakeDecoder.made.push(this);
  }

  configure(config: VideoDecoderConfig): void {
    this.config = config;
    this.state = "configured";
  }

  decode({ timestamp }: EncodedVideoChunk): void {
    if (FakeDecoder.behaviour === "fails") this.init.error(new DOMException("broken"));
    if (FakeDecoder.behaviour === "decodes") this.init.output({ timestamp, close: () => {} } as VideoFrame);
  }

  close(): void {
    this.state = "closed";
  }
}

beforeEach(() => {
  FakeDecoder.made = [];
  FakeDecoder.behaviour = "decodes";
  vi.stubGlobal("VideoDecoder", FakeDecoder);
  vi.stubGlobal(
    "EncodedVideoChunk",
    class {
      timestamp: number;
      constructor(init: EncodedVideoChunkInit) {
        this.timestamp = init.timestamp;
      }
    },
  );
  vi.useFakeTimers();
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

const packet = (isKey: boolean, width = 64): VideoPacket => ({ codec: "h264", isKey, width, height: 64, data: KEY });

it("a key frame configures the decoder for no delay, and those after it use the same one", async () => {
  const decoder = new PacketDecoder();
  await decoder.decode(packet(true));
  await decoder.decode(packet(false));
  await decoder.decode(packet(true));
  expect(FakeDecoder.made.map(({ config }) => [config?.codec, config?.optimizeForLatency])).toEqual([
    ["avc1.F4000A", true],
  ]);
  await decoder.decode(packet(true, 128));
  expect(FakeDecoder.made.map(({ state }) => state)).toEqual(["closed", "configured"]);
});

it("nothing is decoded before a key frame", async () => {
  await expect(new PacketDecoder().decode(packet(false))).rejects.toThrow("key frame");
});

it("a decoder that holds a frame back has failed, and begins anew with a key frame", async () => {
  const decoder = new PacketDecoder();
  FakeDecoder.behaviour = "holds back";
  const failed = expect(decoder.decode(packet(true))).rejects.toThrow(`${LATEST_MS} ms`);
  await vi.advanceTimersByTimeAsync(LATEST_MS);
  await failed;
  FakeDecoder.behaviour = "decodes";
  await expect(decoder.decode(packet(false))).rejects.toThrow("key frame");
  await decoder.decode(packet(true));
});

it("an error of the decoder ends all that was waited for", async () => {
  const decoder = new PacketDecoder();
  FakeDecoder.behaviour = "fails";
  await expect(decoder.decode(packet(true))).rejects.toThrow("broken");
});
