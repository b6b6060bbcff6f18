/** One session's stream: a WebSocket that is opened again when it breaks, and says honestly how it is. */

import { type Frame, FrameError, parseFrame } from "@culet/protocol/frame";
import {
  type ControlEvent,
  FINAL_CLOSE_CODES,
  type Notice,
  SUBPROTOCOL,
  WATCH_SUBPROTOCOL,
} from "@culet/protocol/messages";
import { NoticeError, parseNotice } from "@culet/protocol/notice";
import { words } from "../words/words";
import type { Sent } from "./acknowledged";
import { Latency } from "./latency";

export type Connection =
  | { status: "connecting" }
  | { status: "open" }
  /** Lost; tried again after `delay` milliseconds. */
  | { status: "waiting"; delay: number }
  /** Over: the code says why, and nothing is tried again. */
  | { status: "closed"; code: number; reason: string };

export interface StreamListener {
  connection: (connection: Connection) => void;
  notice: (notice: Notice) => void;
  frame: (frame: Frame) => void;
  /** A message that is neither; the stream goes on. */
  malformed: (error: Error) => void;
}

/** Milliseconds before each new try; the last one holds for all that follow. */
export const PAUSES = [250, 500, 1000, 2000, 4000, 8000];

/** Milliseconds before the next try, after so many that failed. */
export function pauseBefore(tries: number): number {
  return PAUSES[Math.min(tries, PAUSES.length - 1)] ?? 0;
}

export const PING_MS = 1000;
/** A connection that brings nothing during so many pings is dead, whatever the operating system thinks. */
export const LOST_PINGS = 8;

export class Stream {
  readonly latency = new Latency();
  private readonly url: string;
  private readonly listener: StreamListener;
  private readonly protocols: readonly string[];
  private readonly jitter: () => number;
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private pinger: ReturnType<typeof setInterval> | undefined;
  private tries = 0;
  private connections = 0;
  private count = 0;
  private now: Connection = { status: "connecting" };

  /**
   * `jitter` spreads the viewers of a restarted gateway: each pause is multiplied by it. `watch`: the watch id of a
   * session that is only looked at, where the address does not name it.
   */
  constructor(
    url: string,
    listener: StreamListener,
    jitter = () => 0.75 + 0.5 * Math.random(),
    watch: string | null = null,
  ) {
    this.url = url;
    this.protocols = watch === null ? [SUBPROTOCOL] : [SUBPROTOCOL, WATCH_SUBPROTOCOL + watch];
    this.listener = listener;
    this.jitter = jitter;
  }

  get connection(): Connection {
    return this.now;
  }

  /** Messages by the present connection, or by the last one. */
  get sent(): Sent {
    return { connection: this.connections, count: this.count };
  }

  open(): void {
    clearTimeout(this.timer);
    this.become({ status: "connecting" });
    const socket = new WebSocket(this.url, [...this.protocols]);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    // A socket that was given up may still speak: only the present one is heard.
    const ifPresent =
      <E extends Event>(handle: (event: E) => void) =>
      (event: E) =>
        this.socket === socket && handle(event);
    socket.onopen = ifPresent(() => this.opened());
    socket.onmessage = ifPresent((event: MessageEvent<unknown>) => this.received(event.data));
    socket.onclose = ifPresent((event: CloseEvent) => this.lost(event.code, event.reason));
  }

  /** Do not wait for the rest of a pause: the network is back, or the page is looked at again. */
  retryNow(): void {
    if (this.now.status === "waiting") this.open();
  }

  /** Begin anew, since something of it was lost: the server tells everything to whoever joins. */
  reopen(): void {
    this.socket?.close();
    this.lost(1006);
  }

  /** Whether it was sent: events are not kept for later, since a drag of ten seconds ago means nothing. */
  send(event: ControlEvent): boolean {
    if (this.now.status !== "open" || !this.socket) return false;
    this.socket.send(JSON.stringify(event));
    this.count += 1;
    return true;
  }

  /** Give up for good. */
  close(code = 1000, reason = words.connection.closedHere): void {
    const socket = this.socket;
    this.end();
    socket?.close(1000);
    this.become({ status: "closed", code, reason });
  }

  private opened(): void {
    this.tries = 0;
    this.connections += 1;
    this.count = 0;
    this.latency.reset();
    this.pinger = setInterval(() => this.ping(), PING_MS);
    this.become({ status: "open" });
    this.ping();
  }

  private ping(): void {
    if (this.latency.unanswered < LOST_PINGS) this.send(this.latency.ping(performance.now()));
    else {
      this.socket?.close();
      this.lost(1006);
    }
  }

  private received(data: unknown): void {
    this.latency.heard();
    try {
      if (data instanceof ArrayBuffer) this.listener.frame(parseFrame(data));
      else this.heard(parseNotice(String(data)));
    } catch (error) {
      if (!(error instanceof FrameError || error instanceof NoticeError)) throw error;
      this.listener.malformed(error);
    }
  }

  private heard(notice: Notice | null): void {
    if (notice?.type === "pong") this.latency.pong(notice, performance.now());
    if (notice) this.listener.notice(notice);
  }

  private lost(code: number, reason = ""): void {
    this.end();
    if (FINAL_CLOSE_CODES.includes(code)) {
      this.become({ status: "closed", code, reason });
      return;
    }
    const delay = Math.round(pauseBefore(this.tries) * this.jitter());
    this.tries += 1;
    this.timer = setTimeout(() => this.open(), delay);
    this.become({ status: "waiting", delay });
  }

  private end(): void {
    this.socket = null;
    clearTimeout(this.timer);
    clearInterval(this.pinger);
  }

  private become(connection: Connection): void {
    this.now = connection;
    this.listener.connection(connection);
  }
}
