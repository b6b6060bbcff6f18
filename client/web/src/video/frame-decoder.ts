/**
 * Pictures of frames, whatever their codec. Video is offered where it pays (`VideoChoice`): the server is told of
 * decoders once they have proven themselves, and of none any more when they fail. A frame of a broken chain has no
 * picture; others follow.
 */

import { Codec, Flag, type Frame } from "@culet/protocol/frame";
import type { VideoCodec } from "./codec-string";
import type { VideoWork } from "./video-work";

/** A decoder that fails is given a new key frame; after so many failures frames are to be pictures of their own. */
export const MOST_FAILURES = 2;

const MIME: Partial<Record<Codec, string>> = { [Codec.JPEG]: "image/jpeg", [Codec.PNG]: "image/png" };
const VIDEO: Partial<Record<Codec, VideoCodec>> = { [Codec.H264]: "h264", [Codec.VP9]: "vp9" };

/** MIME type of a frame that is a picture of its own; undefined of video. */
export function pictureType({ codec }: Pick<Frame, "codec">): string | undefined {
  return MIME[codec];
}

/** The codec of a frame of video; undefined of a picture of its own. */
export function videoCodec({ codec }: Pick<Frame, "codec">): VideoCodec | undefined {
  return VIDEO[codec];
}

export interface DecoderWorld {
  /** Tell the server which video is decoded here: again, for a key frame. */
  tell: (codecs: VideoCodec[]) => void;
  /** Load what decodes video; null where the browser has nothing for it. */
  load: () => Promise<VideoWork | null>;
}

export class FrameDecoder {
  private readonly world: DecoderWorld;
  private work: VideoWork | null = null;
  private offered: Promise<void> | null = null;
  private codecs: VideoCodec[] = [];
  private failures = 0;
  private broken = false;
  /** The server was told of decoders, and not of none since. */
  private wanted = false;
  /** Number of the packet that was decoded last: the next one needs its picture. */
  private decoded: number | null = null;

  constructor(world: DecoderWorld) {
    this.world = world;
  }

  /** The server makes video: tell it of what is decoded here, once that is known. At every connection. */
  async offer(encodes: readonly VideoCodec[]): Promise<void> {
    if (encodes.length === 0 || this.failures >= MOST_FAILURES) return;
    this.offered ??= this.tryOut(encodes);
    await this.offered;
    this.broken = false;
    this.wanted = true;
    if (this.codecs.length > 0) this.world.tell(this.codecs);
  }

  /** The server is to send pictures of their own. What is under way of the video is decoded still. */
  withdraw(): void {
    this.wanted = false;
    if (this.codecs.length > 0) this.world.tell([]);
  }

  /** Null: of a chain that is broken. */
  async decode(frame: Frame): Promise<ImageBitmap | null> {
    const codec = videoCodec(frame);
    if (codec === undefined) return createImageBitmap(new Blob([frame.payload], { type: MIME[frame.codec] ?? "" }));
    const isKey = (frame.flags & Flag.KEY) !== 0;
    if (!this.work || (this.broken && !isKey)) return null;
    if (!isKey && frame.dependsOn !== this.decoded) {
      this.broken = true; // a packet is missing, which is no fault of the decoder
      this.askForKey();
      return null;
    }
    this.broken = false;
    this.decoded = frame.sequence;
    try {
      const { width, height, payload } = frame;
      return await this.work.decode({ codec, isKey, width, height, data: payload });
    } catch {
      this.fail();
      return null;
    }
  }

  private async tryOut(encodes: readonly VideoCodec[]): Promise<void> {
    try {
      this.work = await this.world.load();
      this.codecs = (await this.work?.trusted(encodes)) ?? [];
    } catch {
      this.codecs = [];
    }
    if (this.codecs.length === 0) this.end();
  }

  private fail(): void {
    if (this.broken) return; // of the same chain
    this.broken = true;
    this.failures += 1;
    if (this.failures >= MOST_FAILURES) {
      this.codecs = [];
      this.end();
    }
    this.askForKey();
  }

  /** The chain begins anew, unless what is under way is the last of it. */
  private askForKey(): void {
    if (this.wanted) this.world.tell(this.codecs);
  }

  private end(): void {
    this.work?.end();
    this.work = null;
  }
}
