/** The way to the gateway and back, by pings. */

import type { Ping, Pong } from "@culet/protocol/messages";

export class Latency {
  /** Pings since anything was last heard: on a slow line a pong comes behind the pictures that were sent before it. */
  unanswered = 0;
  /** Milliseconds of the last round trip. */
  milliseconds: number | null = null;

  ping(now: number): Ping {
    this.unanswered += 1;
    return { type: "ping", time: now };
  }

  heard(): void {
    this.unanswered = 0;
  }

  pong(pong: Pong, now: number): void {
    this.milliseconds = Math.max(0, now - pong.time);
  }

  reset(): void {
    this.unanswered = 0;
    this.milliseconds = null;
  }
}
