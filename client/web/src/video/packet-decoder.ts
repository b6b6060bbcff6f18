/** Packets in, pictures out, one for one and at once: a decoder that holds a frame back, or fails, is given up. */

import { codecString, type VideoCodec } from "./codec-string";

/** ms that a decoder may take for a frame: some thirty times what one of 1280x720 takes on a slow machine. */
export const LATEST_MS = 2000;
/** Between the time stamps of two frames, microseconds; only their order counts. */
const TICK = 33_333;

export interface VideoPacket {
  codec: VideoCodec;
  isKey: boolean;
  width: number;
  height: number;
  data: Uint8Array<ArrayBuffer>;
}

interface Awaited {
  resolve: (picture: VideoFrame) => void;
  reject: (reason: Error) => void;
  timer: ReturnType<typeof setTimeout>;
}

/** As every picture of the server: sRGB, and as many levels as JPEG has. */
const COLOUR: VideoColorSpaceInit = {
  primaries: "bt709",
  transfer: "iec61966-2-1",
  matrix: "bt709",
  fullRange: true,
};

export class PacketDecoder {
  private decoder: VideoDecoder | null = null;
  private configured = "";
  private ticks = 0;
  private readonly awaited = new Map<number, Awaited>();

  /** The picture of a packet, which the caller closes; an Error if there is none, after which a key frame must come. */
  async decode(packet: VideoPacket): Promise<VideoFrame> {
    if (packet.isKey) this.begin(packet);
    const { decoder } = this;
    if (!decoder) throw new Error("expected a key frame first");
    const timestamp = this.ticks * TICK;
    this.ticks += 1;
    const picture = new Promise<VideoFrame>((resolve, reject) => {
      const timer = setTimeout(
        () => this.fail(new Error(`expected a picture within ${LATEST_MS} ms, got none`)),
        LATEST_MS,
      );
      this.awaited.set(timestamp, { resolve, reject, timer });
    });
    try {
      decoder.decode(new EncodedVideoChunk({ type: packet.isKey ? "key" : "delta", timestamp, data: packet.data }));
    } catch (error) {
      this.fail(error instanceof Error ? error : new Error(String(error)));
    }
    return picture;
  }

  close(): void {
    if (this.decoder && this.decoder.state !== "closed") this.decoder.close();
    this.decoder = null;
    this.configured = "";
  }

  private begin({ codec, data, width, height }: VideoPacket): void {
    const name = codecString(codec, data);
    if (name === null) throw new Error("expected a parameter set in a key frame, got none");
    const wanted = `${name} ${width} ${height}`;
    if (this.decoder && this.configured === wanted) return;
    this.close();
    const decoder = new VideoDecoder({
      output: (picture) => this.came(picture),
      error: (error) => this.decoder === decoder && this.fail(error),
    });
    decoder.configure({
      codec: name,
      codedWidth: width,
      codedHeight: height,
      colorSpace: COLOUR,
      optimizeForLatency: true,
    });
    this.decoder = decoder;
    this.configured = wanted;
  }

  private came(picture: VideoFrame): void {
    const awaited = this.awaited.get(picture.timestamp);
    if (!awaited) {
      picture.close();
      return;
    }
    this.awaited.delete(picture.timestamp);
    clearTimeout(awaited.timer);
    awaited.resolve(picture);
  }

  private fail(reason: Error): void {
    this.close();
    const all = [...this.awaited.values()];
    this.awaited.clear();
    for (const { reject, timer } of all) {
      clearTimeout(timer);
      reject(reason);
    }
  }
}
