/** What the last frames took and missed: columns for plots. */

import { Flag, type Frame } from "@culet/protocol/frame";

export const SPAN_SECONDS = 20;
/** ms that a frame covers in a plot at least, some three pixels: so a lone one is seen, and a steady rate has no gaps. */
const LEAST_MS = 200;

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
  /** ms, when it began to be made; at least when the one before came. */
  from: number;
  /** ms, when it was shown. */
  time: number;
  /** Milliseconds of each of STAGES, for one sample. */
  stages: readonly number[];
  /** Of each stage and all before it. */
  sums: readonly number[];
  expected: number | null;
  estimated: number | null;
}

export class FrameHistory {
  private rows: Row[] = [];

  push(frame: Frame, { time, decodeMs, roundTripMs }: Arrival): void {
    const { flags, simulateMs, renderMs, samples, encodeMs } = frame;
    const error = Number.isNaN(frame.error) ? null : frame.error;
    const frontier = (flags & Flag.FRONTIER) !== 0;
    const stages = [simulateMs, renderMs / samples, encodeMs, (roundTripMs ?? 0) / 2, decodeMs];
    const sums = runningSums(stages);
    const took = total(sums) + (renderMs * (samples - 1)) / samples;
    this.rows.push({
      from: Math.max(this.rows.at(-1)?.time ?? Number.NEGATIVE_INFINITY, time - Math.max(took, LEAST_MS)),
      time,
      stages,
      sums,
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

  /** Milliseconds of all stages together of the slowest frame; 0 without any. */
  get slowest(): number {
    return Math.max(0, ...this.rows.map(({ sums }) => total(sums)));
  }

  /** Seconds before the last frame, then for each stage the milliseconds of it and of all before it. */
  stageColumns(): [number[], ...Column[]] {
    return this.steps(...STAGES.map((_, stage) => (row: Row) => row.sums[stage] ?? null));
  }

  /** Seconds before the last frame, the frontier's error of moving frames, the estimated one of those at rest. */
  errorColumns(): [number[], ...Column[]] {
    return this.steps(
      ({ expected }) => expected,
      ({ estimated }) => estimated,
    );
  }

  /** Values of each frame, level from when it began to be made to when it was shown; null while none was made. */
  private steps(...values: ((row: Row) => number | null)[]): [number[], ...Column[]] {
    const corners = this.rows.flatMap((row, index) => {
      const idle = row.from > (this.rows[index - 1]?.time ?? row.from);
      const level = [
        { time: row.from, row },
        { time: row.time, row },
      ];
      return idle ? [{ time: row.from, row: null }, ...level] : level;
    });
    const last = this.rows.at(-1)?.time ?? 0;
    const seconds = corners.map(({ time }) => Math.max((time - last) / 1000, -SPAN_SECONDS));
    return [seconds, ...values.map((value) => corners.map(({ row }) => row && value(row)))];
  }
}

function total(sums: readonly number[]): number {
  return sums.at(-1) ?? 0;
}

function runningSums(values: readonly number[]): number[] {
  let sum = 0;
  return values.map((value) => {
    sum += value;
    return sum;
  });
}
