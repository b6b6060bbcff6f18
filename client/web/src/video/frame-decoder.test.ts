import { Codec, Flag, type Frame, parseFrame } from "@culet/protocol/frame";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { bytes } from "../testing/fixtures";
import type { VideoCodec } from "./codec-string";
import { FrameDecoder } from "./frame-decoder";
import type { VideoWork } from "./video-work";

const GOLDEN = parseFrame(bytes("h264.bin"));
const key: Frame = { ...GOLDEN, flags: GOLDEN.flags | Flag.KEY, dependsOn: 0 };
const delta: Frame = {
  ...GOLDEN,
  flags: GOLDEN.flags & ~Flag.KEY,
  sequence: key.sequence + 1,
  dependsOn: key.sequence,
};
const jpeg: Frame = { ...GOLDEN, codec: Codec.JPEG };

describe("the decoder of frames", () => {
  let told: VideoCodec[][];
  let trusted: VideoCodec[];
  let fails: boolean;
  let loads: number;
  let ended: number;
  let decoder: FrameDecoder;

  beforeEach(() => {
    told = [];
    trusted = ["h264"];
    fails = false;
    loads = ended = 0;
    vi.stubGlobal("createImageBitmap", async ({ type }: Blob) => type);
    const work = {
      trusted: async (codecs: readonly VideoCodec[]) => codecs.filter((codec) => trusted.includes(codec)),
      decode: async () => {
        if (fails) throw new Error("the decoder was killed");
        return "picture" as unknown as ImageBitmap;
      },
      end: () => {
        ended += 1;
      },
    } as unknown as VideoWork;
    decoder = new FrameDecoder({
      tell: (codecs) => told.push([...codecs]),
      load: async () => {
        loads += 1;
        return work;
      },
    });
  });

  afterEach(() => void vi.unstubAllGlobals());

  it("decodes pictures of their own as what they are, and loads nothing for them", async () => {
    expect(await decoder.decode(jpeg)).toBe("image/jpeg");
    expect(loads).toBe(0);
  });

  it("tells the server of decoders that have proven themselves, at every connection", async () => {
    await decoder.offer(["h264", "vp9"]);
    await decoder.offer(["h264", "vp9"]);
    expect(told).toEqual([["h264"], ["h264"]]);
    expect(loads).toBe(1);
    expect(await decoder.decode(key)).toBe("picture");
  });

  it("wants pictures of their own again, and decodes what is still under way", async () => {
    decoder.withdraw();
    expect(told).toEqual([]); // nothing was offered
    await decoder.offer(["h264"]);
    expect(await decoder.decode(key)).toBe("picture");
    decoder.withdraw();
    expect(told).toEqual([["h264"], []]);
    expect(await decoder.decode(delta)).toBe("picture");
    expect(await decoder.decode({ ...delta, dependsOn: delta.sequence + 5 })).toBeNull();
    fails = true;
    expect(await decoder.decode(key)).toBeNull();
    fails = false;
    expect(told).toEqual([["h264"], []]); // and does not ask for more of it
    await decoder.offer(["h264"]);
    expect(told.at(-1)).toEqual(["h264"]);
    expect(loads).toBe(1);
  });

  it("tells nothing where the server makes no video, or no decoder can be trusted", async () => {
    await decoder.offer([]);
    expect(loads).toBe(0);
    trusted = [];
    await decoder.offer(["h264"]);
    expect(told).toEqual([]);
    expect(ended).toBe(1);
  });

  it("asks for a key frame when the decoder fails, and waits for it", async () => {
    await decoder.offer(["h264"]);
    expect(await decoder.decode(key)).toBe("picture");
    fails = true;
    expect(await decoder.decode(delta)).toBeNull();
    fails = false;
    expect(told).toEqual([["h264"], ["h264"]]);
    expect(await decoder.decode(delta)).toBeNull();
    expect(await decoder.decode(jpeg)).toBe("image/jpeg");
    expect(await decoder.decode(key)).toBe("picture");
    expect(await decoder.decode(delta)).toBe("picture");
  });

  it("shows no packet whose picture before is missing, and does not blame the decoder", async () => {
    await decoder.offer(["h264"]);
    expect(await decoder.decode(key)).toBe("picture");
    for (let gaps = 1; gaps <= 3; gaps++) {
      const later = { ...delta, sequence: delta.sequence + 1, dependsOn: delta.sequence };
      expect(await decoder.decode(later)).toBeNull();
      expect(told.length).toBe(1 + gaps);
      expect(await decoder.decode(key)).toBe("picture");
    }
    expect(told.at(-1)).toEqual(["h264"]);
    expect(ended).toBe(0);
  });

  it("goes on with pictures of their own once the decoder has failed twice", async () => {
    await decoder.offer(["h264"]);
    fails = true;
    await decoder.decode(key);
    await decoder.decode(key);
    expect(told).toEqual([["h264"], ["h264"], []]);
    expect(ended).toBe(1);
    expect(await decoder.decode(jpeg)).toBe("image/jpeg");
    await decoder.offer(["h264"]);
    expect(told.length).toBe(3);
  });
});
