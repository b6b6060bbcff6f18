/** Where the pictures of a film are put, one after the other, all at the same size. */

import { letterbox, type PictureSize } from "../picture/picture-size";
import { bitmapOf } from "../video/bitmap";
import { PacketDecoder } from "../video/packet-decoder";
import type { ClipFrame, Packet } from "./clip-frames";

export class Easel {
  readonly canvas = document.createElement("canvas");
  private readonly context: CanvasRenderingContext2D;
  private shown: ClipFrame | null = null;
  private picture: ImageBitmap | null = null;
  private readonly decoder = new PacketDecoder();
  /** That was decoded last. */
  private decoded: Packet | null = null;
  /** That were tried twice in vain: what needs them cannot be shown either. */
  private readonly broken = new WeakSet<Packet>();

  constructor({ width, height }: PictureSize) {
    Object.assign(this.canvas, { width, height });
    const context = this.canvas.getContext("2d", { alpha: false });
    if (!context) throw new Error("expected a 2D canvas, got none from this browser");
    this.context = context;
  }

  /** Nothing more is shown: its pixels are given back at once. */
  close(): void {
    this.picture?.close();
    this.picture = null;
    this.shown = null;
    this.decoder.close();
    this.decoded = null;
  }

  /**
   * `again`: also if it is shown already, since recorders see only what is painted. In place of a frame that cannot be
   * decoded the one before it stays; an Error if there is none.
   */
  async show(frame: ClipFrame, again = false): Promise<void> {
    if (frame === this.shown && !again) return;
    if (frame !== this.shown) {
      const picture = await this.pictureOf(frame);
      if (picture) {
        this.picture?.close();
        this.picture = picture;
      }
      this.shown = frame;
    }
    if (!this.picture) throw new Error("expected a picture that this browser decodes, got none");
    const { x, y, width, height } = letterbox(this.picture, this.canvas);
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(this.picture, x, y, width, height);
  }

  private async pictureOf({ content }: ClipFrame): Promise<ImageBitmap | null> {
    if ("payload" in content) return createImageBitmap(new Blob([content.payload], { type: content.type }));
    const picture = (await this.decode(content, false)) ?? (await this.decode(content, true));
    return picture && bitmapOf(picture);
  }

  /** Of a packet and those that it needs; null if one of them fails, after which all of them are needed anew. */
  private async decode(content: Packet, again: boolean): Promise<VideoFrame | null> {
    const chain: Packet[] = [];
    for (let packet: Packet | null = content; packet && packet !== this.decoded; packet = packet.before) {
      if (this.broken.has(packet)) return null;
      chain.unshift(packet);
    }
    let picture: VideoFrame | null = null;
    for (const packet of chain) {
      picture?.close();
      picture = null;
      try {
        picture = await this.decoder.decode(packet);
        this.decoded = packet;
      } catch {
        this.decoded = null;
        if (again) this.broken.add(packet);
        return null;
      }
    }
    if (!picture) throw new Error("expected pictures in their order");
    return picture;
  }
}
