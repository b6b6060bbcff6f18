/** Frames in, pictures out: decoded one after the other, never shown out of order, each acknowledged once. */

import type { Frame } from "@culet/protocol/frame";

export type Order = Pick<Frame, "sequence">;

/** Whether a frame comes after another one of the same engine. Sequences wrap after 32 bits. */
export function isAfter(frame: Order, other: Order): boolean {
  return ((frame.sequence - other.sequence) | 0) > 0;
}

export interface Player<Picture> {
  /** Null: it has no picture, as after a frame that it needs and that is lost. */
  decode: (frame: Frame) => Promise<Picture | null>;
  show: (picture: Picture, frame: Frame) => void;
  /** The frame is done with, shown or not: without this its place in the gateway's window would be lost. */
  acknowledge: (frame: Frame) => void;
  fail: (frame: Frame, reason: unknown) => void;
}

export class FramePlayer<Picture> {
  /** Frames that came later than one that should have followed them. */
  outOfOrder = 0;
  shown = 0;
  private newest: Order | null = null;
  private queue: Promise<void> = Promise.resolve();
  private readonly player: Player<Picture>;

  constructor(player: Player<Picture>) {
    this.player = player;
  }

  /** Whatever comes next is new: it is from another engine, or another connection. */
  forget(): void {
    this.newest = null;
  }

  /** Take a frame; the promise ends when it is acknowledged. How many wait here is bounded by the gateway's window. */
  push(frame: Frame): Promise<void> {
    if (this.newest && !isAfter(frame, this.newest)) {
      if (frame.sequence !== this.newest.sequence) this.outOfOrder += 1; // the same one again is a repeated still
      this.queue = this.queue.then(() => this.player.acknowledge(frame));
    } else {
      this.newest = frame;
      this.queue = this.queue.then(() => this.play(frame));
    }
    return this.queue;
  }

  private async play(frame: Frame): Promise<void> {
    try {
      const picture = await this.player.decode(frame);
      if (picture !== null) {
        this.player.show(picture, frame);
        this.shown += 1;
      }
    } catch (reason) {
      this.player.fail(frame, reason);
    }
    this.player.acknowledge(frame);
  }
}
