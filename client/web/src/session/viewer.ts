/** One session on this page: stream, frames and state together. */

import type { Frame } from "@culet/protocol/frame";
import type { ControlEvent, JsonObject, Notice, Outlined, Picked, Problem, Reached } from "@culet/protocol/messages";
import { BottleneckMeter } from "../meter/bottleneck";
import type { Arrival } from "../meter/frame-history";
import type { PictureSize } from "../picture/picture-size";
import type { VideoCodec } from "../video/codec-string";
import { FrameDecoder } from "../video/frame-decoder";
import { loadVideo } from "../video/load";
import { savesData, VideoChoice } from "../video/video-choice";
import { words } from "../words/words";
import type { Target } from "./events";
import { FramePlayer } from "./frame-player";
import { FrameRate } from "./frame-rate";
import { type Connection, Stream } from "./stream";
import { INITIAL, isAmiss, type ViewState, withNotice } from "./view-state";

export interface ViewerListener {
  show: (picture: ImageBitmap, frame: Frame, arrival: Arrival) => void;
  size: () => PictureSize;
  connection: (connection: Connection) => void;
  state: (before: ViewState, after: ViewState) => void;
  /** A question of this viewer is answered. */
  answer: (answer: Picked | Outlined | Reached) => void;
  /** A new render process lacks what the session needs. */
  lacking: () => void;
  /** Something was refused; whether who did it is told, and sends it again if it can be. */
  refused: (problem: Problem) => boolean;
  /** `about`: the field of the scene that was refused, if it was that. */
  problem: (text: string, about?: string) => void;
}

export class Viewer {
  readonly stream: Stream;
  readonly rate = new FrameRate();
  readonly bottleneck = new BottleneckMeter();
  readonly player: FramePlayer<ImageBitmap>;
  lastFrame: Frame | null = null;
  /** What the server needs, besides the scene, to make the session again if it loses it. */
  snapshot: JsonObject | null = null;
  /** By which others may look at the session; null until the server has said so. */
  watchId: string | null = null;
  /** The server said that the session ends: it is not lost. */
  ended = false;
  state: ViewState = INITIAL;
  private readonly listener: ViewerListener;
  /** Video that the server makes. */
  private encodes: readonly VideoCodec[] = [];
  /** Whether the server is to send it. */
  private readonly video = new VideoChoice(savesData());
  private decodeMs = 0;
  private readonly decoder = new FrameDecoder({
    tell: (codecs) => this.stream.send({ type: "decoders", codecs }),
    load: loadVideo,
  });
  /** The revision of the state when something was sent last. */
  private spoken: number | null = null;

  /** `watch`: the watch id of a session that is only looked at, where the address does not name it. */
  constructor(url: string, listener: ViewerListener, watch: string | null = null) {
    this.listener = listener;
    this.player = new FramePlayer<ImageBitmap>({
      decode: (frame) => this.decode(frame),
      show: (picture, frame) => this.show(picture, frame),
      acknowledge: (frame) => this.stream.send({ type: "ack", sequence: frame.sequence }),
      fail: (frame, reason) => listener.problem(words.connection.notDecoded(frame.sequence, String(reason))),
    });
    this.stream = new Stream(
      url,
      {
        connection: (connection) => this.connected(connection),
        notice: (notice) => this.heard(notice),
        frame: (frame) => void this.player.push(frame),
        malformed: (error) => listener.problem(words.connection.notUnderstood(error.message)),
      },
      undefined,
      watch,
    );
    document.addEventListener("visibilitychange", () => {
      this.sendVisibility();
      if (!document.hidden) this.stream.retryNow();
    });
    window.addEventListener("online", () => this.stream.retryNow());
  }

  /** What would change a session that is only watched stays here: the server would refuse it. */
  send(event: ControlEvent): void {
    if (!this.state.steers) return;
    this.spoken = this.state.revision;
    if (!this.stream.send(event)) this.listener.problem(words.connection.notSent);
  }

  /** Something was sent, and nothing was heard of the session since: the state may not be what it leads to. */
  get untold(): boolean {
    return this.spoken !== null && this.spoken === this.state.revision;
  }

  resize(size: PictureSize): void {
    this.stream.send({ type: "resize", ...size });
  }

  select(target: Target): void {
    this.become({ ...this.state, target });
  }

  choose(stone: string | null): void {
    this.become({ ...this.state, stone });
  }

  /** As `send`, of what needs no complaint if it cannot be sent. */
  ask(event: ControlEvent): void {
    this.stream.send(event);
  }

  private connected(connection: Connection): void {
    if (connection.status === "open") {
      this.resize(this.listener.size());
      this.sendVisibility();
    }
    this.listener.connection(connection);
  }

  private sendVisibility(): void {
    this.stream.send({ type: "visibility", visible: !document.hidden });
  }

  private heard(notice: Notice): void {
    if (notice.type === "hello") {
      this.watchId = notice.watch;
      this.encodes = notice.encodes ?? [];
      if (this.lastFrame && this.video.on) void this.decoder.offer(this.encodes);
    }
    if (notice.type === "hello" || notice.type === "engine") this.player.forget();
    if (notice.type === "picked" || notice.type === "outlined" || notice.type === "reached")
      this.listener.answer(notice);
    else if (notice.type === "snapshot") this.snapshot = notice.snapshot;
    else if (notice.type === "problem") {
      this.ended ||= notice.code === "session_closed";
      if (notice.code === "session_lost") this.listener.lacking();
      if (!this.listener.refused(notice)) this.listener.problem(notice.message, notice.field ?? undefined);
    } else if (isAmiss(this.state, notice)) this.stream.reopen();
    else this.become(withNotice(this.state, notice));
  }

  private become(state: ViewState): void {
    const before = this.state;
    this.state = state;
    if (before !== state) this.listener.state(before, state);
  }

  private show(picture: ImageBitmap, frame: Frame): void {
    const isFirst = this.lastFrame === null; // nothing is loaded before the first picture
    this.lastFrame = frame;
    const time = performance.now();
    this.rate.shown(time);
    this.bottleneck.shown(frame, time, this.decodeMs);
    const changed = this.video.shown(frame, time, this.bottleneck.at(time));
    if (this.video.on && (isFirst || changed)) void this.decoder.offer(this.encodes);
    else if (changed) this.decoder.withdraw();
    this.listener.show(picture, frame, {
      time,
      decodeMs: this.decodeMs,
      roundTripMs: this.stream.latency.milliseconds,
    });
  }

  private async decode(frame: Frame): Promise<ImageBitmap | null> {
    const started = performance.now();
    const picture = await this.decoder.decode(frame);
    this.decodeMs = performance.now() - started;
    return picture;
  }
}
