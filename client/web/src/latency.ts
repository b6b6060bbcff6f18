/** The way to the gateway and back, by pings. */

import type { Ping, Pong } from "@culet/protocol/messages";

export class Latency {
  /** Pings since the last pong. */
  unanswered = 0;
  /** Milliseconds of the last round trip. */
  milliseconds: number | null = null;

  ping(now: number): Ping {
    this.unanswered += 1;
    return { type: "ping", time: now };
  }

  pong(pong: Pong, now: number): void {
    this.unanswered = 0;
    this.milliseconds = Math.max(0, now - pong.time);
  }

  reset(): void {
    this.unanswered = 0;
    this.milliseconds = null;
  }
}
