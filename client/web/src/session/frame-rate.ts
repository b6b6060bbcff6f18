/** Frames shown a second, over the last two. */

const WINDOW_MS = 2000;

export class FrameRate {
  private times: number[] = [];

  shown(now: number): void {
    this.times.push(now);
    this.forget(now);
  }

  perSecond(now: number): number {
    this.forget(now);
    return this.times.length / (WINDOW_MS / 1000);
  }

  private forget(now: number): void {
    this.times = this.times.filter((time) => time > now - WINDOW_MS);
  }
}
