/** Two plots of the last seconds: time by stage, and error. Loaded when they are first looked at. */

import uPlot from "uplot";
import "../../node_modules/uplot/dist/uPlot.min.css"; // a style sheet of our own origin, as lil-gui's
import { words } from "../words/words";
import { type Column, type FrameHistory, SPAN_SECONDS, STAGES } from "./frame-history";
import { milliseconds, significant } from "./status-text";

interface Curve {
  name: string;
  colour: string;
  /** For a tooltip, where the name does not say enough. */
  meaning?: string;
}

const QUIET = "#a4adbd";
/** Of the stages in turn; apart from each other to colour-blind eyes too. */
const STAGE_COLOURS = ["#b49cf0", "#6f9bf5", "#4fc3b0", "#e0be62", "#f08c78"];
const STAGE_CURVES: readonly Curve[] = STAGES.map((stage, index) => {
  return { name: words.meter.stages[stage], colour: STAGE_COLOURS[index] ?? QUIET };
});
const ERRORS: readonly Curve[] = [
  { name: words.meter.frontier, colour: "#e0be62", meaning: words.errors.frontier },
  { name: words.meter.estimated, colour: "#8fb4ff", meaning: words.errors.estimated },
];
const LINE = "rgb(164 173 189 / 14%)";
const FONT = "11px system-ui, sans-serif";
const HEIGHT = 108;

export class Plots {
  private readonly stages: uPlot;
  private readonly errors: uPlot;
  private readonly values: HTMLElement[];
  private readonly history: FrameHistory;
  private budget: number | null = null;

  constructor(container: HTMLElement, history: FrameHistory, width: number) {
    this.history = history;
    const time = figure(container, words.meter.stagesTitle, STAGE_CURVES);
    this.stages = new uPlot(this.stageOptions(width), stacked(history), time.plot);
    const error = figure(container, words.meter.errorsTitle, ERRORS);
    this.errors = new uPlot(errorOptions(width), history.errorColumns(), error.plot);
    this.values = [...time.values, ...error.values];
  }

  /** `budget`: milliseconds that a frame may take, if a rate is asked for. */
  draw(budget: number | null): void {
    this.budget = budget;
    const errors = this.history.errorColumns();
    this.stages.setData(stacked(this.history));
    this.errors.setData(errors);
    const latest = [
      ...STAGES.map((_, stage) => milliseconds(this.history.latest[stage] ?? 0)),
      ...errors.slice(1).map((column) => latestOf(column)),
    ];
    for (const [index, value] of this.values.entries()) value.textContent = latest[index] ?? "";
  }

  resize(width: number): void {
    for (const plot of [this.stages, this.errors]) plot.setSize({ width, height: HEIGHT });
  }

  private stageOptions(width: number): uPlot.Options {
    const series = STAGE_CURVES.map(({ name, colour }) => {
      return { label: name, stroke: colour, fill: colour, width: 0.5, points: { show: false } };
    }).reverse();
    return {
      ...options(width),
      scales: { x: span(), y: { range: () => [0, 1.1 * Math.max(this.history.slowest, this.budget ?? 0, 1)] } },
      axes: [seconds(), axis((value) => value.toFixed(0))],
      series: [{}, ...series],
      hooks: { draw: [(plot) => this.drawBudget(plot)] },
    };
  }

  private drawBudget(plot: uPlot): void {
    if (this.budget === null) return;
    const { ctx, bbox } = plot;
    const y = plot.valToPos(this.budget, "y", true);
    ctx.save();
    ctx.strokeStyle = "#ffffff";
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }
}

/** The highest sums first, so that each lower one is drawn over them. */
function stacked(history: FrameHistory): [number[], ...Column[]] {
  const [times, ...sums] = history.stageColumns();
  return [times, ...sums.reverse()];
}

function options(width: number): Pick<uPlot.Options, "width" | "height" | "legend" | "cursor" | "padding"> {
  return { width, height: HEIGHT, legend: { show: false }, cursor: { show: false }, padding: [6, 16, 0, 0] };
}

function errorOptions(width: number): uPlot.Options {
  const series = ERRORS.map(({ name, colour }) => {
    return { label: name, stroke: colour, width: 2, points: { show: false } };
  });
  return {
    ...options(width),
    scales: { x: span(), y: { distr: 3, log: 10, range: (_, least, most) => decades(least, most) } },
    axes: [seconds(), axis(significant)],
    series: [{}, ...series],
  };
}

function span(): uPlot.Scale {
  return { time: false, range: [-SPAN_SECONDS, 0] };
}

function seconds(): uPlot.Axis {
  return {
    ...axis((value) => (value === 0 ? words.meter.now : words.meter.seconds(value))),
    size: 24,
    gap: 5,
    space: 60,
  };
}

function axis(text: (value: number) => string): uPlot.Axis {
  return {
    stroke: QUIET,
    font: FONT,
    size: 42,
    gap: 3,
    space: 24,
    grid: { stroke: LINE, width: 1 },
    ticks: { show: false },
    values: (_, values) => values.map((value) => (value === null ? null : text(value))),
  };
}

/** Whole decades around what there is. */
function decades(least: number | null, most: number | null): [number, number] {
  if (!least || !most) return [1e-3, 1];
  return [10 ** Math.floor(Math.log10(least)), 10 ** (Math.floor(Math.log10(most)) + 1)];
}

function latestOf(column: (number | null)[]): string {
  const value = column.at(-1);
  return value === null || value === undefined ? "" : significant(value);
}

/** A heading, a plot's place and a legend whose values are filled in. */
function figure(
  container: HTMLElement,
  title: string,
  curves: readonly Curve[],
): { plot: HTMLElement; values: HTMLElement[] } {
  const whole = document.createElement("figure");
  const caption = document.createElement("figcaption");
  caption.textContent = title;
  const plot = document.createElement("div");
  const legend = document.createElement("ul");
  const values = curves.map(({ name, colour, meaning }) => {
    const item = document.createElement("li");
    const value = document.createElement("b");
    item.style.setProperty("--colour", colour);
    if (meaning) item.title = meaning;
    item.append(`${name} `, value);
    legend.append(item);
    return value;
  });
  whole.append(caption, plot, legend);
  container.append(whole);
  return { plot, values };
}
