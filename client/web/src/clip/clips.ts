/** Clips of what is seen: of the last seconds, or of the next ones. */

import type { Frame } from "@culet/protocol/frame";
import { download } from "../files/files";
import type { Task } from "../signs/toasts";
import { words } from "../words/words";
import { type ClipFrame, ClipFrames, LONGEST_MS } from "./clip-frames";
import { timeline } from "./clip-timeline";
import { filmOf } from "./film";

/** ms for which the last picture of a clip stays, once nothing moves. */
const HOLD_MS = 1000;
/** Between two words of how long a recording goes on. */
const TOLD_MS = 100;

export interface ClipWorld {
  /** Tell of something that goes on, with a button that ends it. */
  task: (text: string, button: string, end: () => void) => Task;
  /** Whether the next seconds are being recorded has changed. */
  recording: (on: boolean) => void;
}

export class Clips {
  private readonly frames = new ClipFrames();
  private readonly world: ClipWorld;
  /** Ends the recording that goes on. */
  private stop: (() => void) | null = null;
  /** Settled once no clip is being made any more. */
  private made: Promise<void> = Promise.resolve();

  constructor(world: ClipWorld) {
    this.world = world;
  }

  /** A frame is on the screen, at a time in ms. */
  take(frame: Frame, time: number): void {
    this.frames.take(frame, time);
  }

  /** Save the last seconds in which anything moved; throws Error with words for the user. */
  async last(): Promise<void> {
    const lastTime = this.frames.lastTime;
    if (lastTime === null) throw new Error(words.files.noPicture);
    const to = Math.min(performance.now(), lastTime + HOLD_MS);
    await this.save(to - LONGEST_MS, to);
  }

  /** Record the next seconds, or stop and save what was recorded since. */
  async record(): Promise<void> {
    if (this.stop) return this.stop();
    if (this.frames.lastTime === null) throw new Error(words.files.noPicture);
    const since = performance.now();
    await this.recorded(since);
    await this.save(since, Math.min(performance.now(), since + LONGEST_MS));
  }

  /** Until somebody stops it, or the longest clip is full. */
  private async recorded(since: number): Promise<void> {
    const over = new Promise<void>((resolve) => {
      this.stop = resolve;
    });
    const stop = () => this.stop?.();
    const task = this.world.task(words.clip.recording(LONGEST_MS / 1000), words.clip.stop, stop);
    const timer = setInterval(() => {
      const part = (performance.now() - since) / LONGEST_MS;
      task.progress(part);
      if (part >= 1) stop();
    }, TOLD_MS);
    this.world.recording(true);
    await over;
    clearInterval(timer);
    task.end();
    this.stop = null;
    this.world.recording(false);
  }

  /** A file of what was seen from one time to another, ms: after those that are being made. */
  private save(from: number, to: number): Promise<void> {
    const frames = this.frames.between(from, to); // now: they are not kept for long
    const begin = Math.max(from, frames[0]?.time ?? from);
    const before = this.made;
    const made = before.then(() => this.make(timeline(frames, begin, to)));
    this.made = made.catch(() => undefined); // whoever asked for that one is told
    return made;
  }

  private async make(frames: readonly ClipFrame[]): Promise<void> {
    const making = new AbortController();
    const task = this.world.task(words.clip.making, words.clip.cancel, () => making.abort());
    try {
      const film = await filmOf(frames, { progress: (part) => task.progress(part), signal: making.signal });
      download(film.file, `culet-clip.${film.ending}`);
    } catch (error) {
      if (!making.signal.aborted) throw error;
    } finally {
      task.end();
    }
  }
}
