/** Where the pictures of a film are put, one after the other, all at the same size. */

import { letterbox, type Size } from "../picture/picture-size";
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

  constructor({ width, height }: Size) {
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

  /** `again`: also if it is shown already, since recorders see only what is painted. */
  async show(frame: ClipFrame, again = false): Promise<void> {
    if (frame === this.shown && !again) return;
    if (frame !== this.shown) {
      this.picture?.close();
      this.picture = await this.pictureOf(frame);
      this.shown = frame;
    }
    if (!this.picture) return;
    const { x, y, width, height } = letterbox(this.picture, this.canvas);
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(this.picture, x, y, width, height);
  }

  private async pictureOf({ content }: ClipFrame): Promise<ImageBitmap> {
    if ("payload" in content) return createImageBitmap(new Blob([content.payload], { type: content.type }));
    const chain: Packet[] = [];
    for (let packet: Packet | null = content; packet && packet !== this.decoded; packet = packet.before) {
      chain.unshift(packet);
    }
    let picture: VideoFrame | null = null;
    for (const packet of chain) {
      picture?.close();
      picture = await this.decoder.decode(packet);
      this.decoded = packet;
    }
    if (!picture) throw new Error("expected pictures in their order");
    return bitmapOf(picture);
  }
}
