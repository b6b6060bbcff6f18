/** ISO brightness as the stone tilts about either axis. Loaded when it is first asked for. */

import uPlot from "uplot";
import "../../node_modules/uplot/dist/uPlot.min.css"; // a style sheet of our own origin
import { words } from "../words/words";
import { type TiltColumns, tiltText } from "./grades";

const HEIGHT = 150;
const QUIET = "#a4adbd";
const LINE = "rgb(164 173 189 / 14%)";
const FONT = "11px system-ui, sans-serif";
/** Apart from each other to colour-blind eyes too. */
const COLOURS = ["#e0be62", "#6f9bf5"] as const;

export type TiltPlot = Pick<uPlot, "destroy">;

/** Fill the container; whoever empties it destroys the plot first. */
export function plotTilt(container: HTMLElement, columns: TiltColumns, width: number): TiltPlot {
  const axis = { stroke: QUIET, font: FONT, grid: { stroke: LINE, width: 1 }, ticks: { stroke: LINE, width: 1 } };
  const series = words.grades.axes.map((label, index) => ({ label, stroke: COLOURS[index] ?? QUIET, width: 1.5 }));
  const legend = document.createElement("p");
  for (const { label, stroke } of series) {
    const name = document.createElement("span");
    name.textContent = label;
    name.style.setProperty("--colour", stroke);
    legend.append(name, " ");
  }
  const options: uPlot.Options = {
    width,
    height: HEIGHT,
    scales: { x: { time: false }, y: { range: [0, 100] } },
    series: [{ label: words.grades.degrees }, ...series],
    axes: [axis, { ...axis, size: 40 }],
    legend: { show: false },
    cursor: { drag: { x: false, y: false } },
  };
  container.replaceChildren(legend);
  const plot = new uPlot(options, columns, container);
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", tiltText(columns));
  return plot;
}
