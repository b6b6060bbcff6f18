/** What the last frames took and missed: columns for plots. */

import { Flag, type Frame } from "@culet/protocol/frame";

export const SPAN_SECONDS = 20;
/** Frames farther apart are not joined by a line. */
const GAP_SECONDS = 1;

export const STAGES = ["simulate", "render", "encode", "network", "decode"] as const;

/** What only this side knows of a frame. */
export interface Arrival {
  /** ms, when it was shown. */
  time: number;
  decodeMs: number;
  roundTripMs: number | null;
}

export type Column = (number | null)[];

interface Row {
  time: number;
  /** Milliseconds of each of STAGES, for one sample; null in a gap. */
  stages: readonly number[] | null;
  expected: number | null;
  estimated: number | null;
}

export class FrameHistory {
  private rows: Row[] = [];

  push(frame: Frame, { time, decodeMs, roundTripMs }: Arrival): void {
    const last = this.rows.at(-1);
    if (last && time - last.time > GAP_SECONDS * 1000) {
      this.rows.push({ time: last.time + 1, stages: null, expected: null, estimated: null });
    }
    const { flags, simulateMs, renderMs, samples, encodeMs } = frame;
    const error = Number.isNaN(frame.error) ? null : frame.error;
    const frontier = (flags & Flag.FRONTIER) !== 0;
    this.rows.push({
      time,
      stages: [simulateMs, renderMs / samples, encodeMs, (roundTripMs ?? 0) / 2, decodeMs],
      expected: frontier ? error : null,
      estimated: frontier ? null : error,
    });
    this.rows = this.rows.filter((row) => row.time >= time - SPAN_SECONDS * 1000);
  }

  clear(): void {
    this.rows = [];
  }

  /** Milliseconds of each of STAGES of the last frame. */
  get latest(): readonly number[] {
    return this.rows.at(-1)?.stages ?? [];
  }

  /** Milliseconds that all stages together took, but for the slowest tenth of the frames; 0 without any. */
  get usual(): number {
    const totals = this.rows.flatMap(({ stages }) => (stages ? [stages.reduce((sum, part) => sum + part, 0)] : []));
    return totals.sort((a, b) => a - b)[Math.floor(0.9 * (totals.length - 1))] ?? 0;
  }

  /** Seconds before the last frame, then for each stage the milliseconds of it and of all before it. */
  stageColumns(): [number[], ...Column[]] {
    const sums = this.rows.map(({ stages }) => stages && runningSums(stages));
    return [this.seconds(), ...STAGES.map((_, stage) => sums.map((sum) => sum?.[stage] ?? null))];
  }

  /** Seconds before the last frame, the frontier's error of moving frames, the estimated one of those at rest. */
  errorColumns(): [number[], ...Column[]] {
    return [this.seconds(), this.rows.map(({ expected }) => expected), this.rows.map(({ estimated }) => estimated)];
  }

  private seconds(): number[] {
    const last = this.rows.at(-1)?.time ?? 0;
    return this.rows.map(({ time }) => (time - last) / 1000);
  }
}

function runningSums(values: readonly number[]): number[] {
  let sum = 0;
  return values.map((value) => {
    sum += value;
    return sum;
  });
}
