/** The outline of the chosen stone, over the picture. */

import { type Fit, type PictureSize, placed } from "./picture-size";

/**
 * The corners of an SVG polygon, in pixels of the canvas that shows a picture of that shape. `points` are x and y in turn:
 * right and up from the picture's centre, in halves of its height.
 */
export function polygonOf(
  points: readonly number[],
  picture: PictureSize,
  canvas: PictureSize,
  fit: Fit = "whole",
): string {
  const { x, y, width, height } = placed(picture, canvas, fit);
  const half = height / 2;
  const corners: string[] = [];
  for (let k = 0; k + 1 < points.length; k += 2) {
    const [right, up] = [points[k] ?? 0, points[k + 1] ?? 0];
    corners.push(`${x + width / 2 + half * right},${y + half - half * up}`);
  }
  return corners.join(" ");
}

export class OutlineView {
  private readonly drawing: SVGSVGElement;
  private readonly canvas: HTMLCanvasElement;
  private shown: { points: readonly number[]; picture: PictureSize } | null = null;

  /** The drawing covers the canvas, and holds polygons: the line, and what sets the line off from the picture. */
  constructor(drawing: SVGSVGElement, canvas: HTMLCanvasElement) {
    this.drawing = drawing;
    this.canvas = canvas;
  }

  show(points: readonly number[], picture: PictureSize, fit: Fit): void {
    this.shown = { points, picture };
    const { width, height } = this.canvas;
    this.drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const polygon = polygonOf(points, picture, { width, height }, fit);
    for (const line of this.drawing.querySelectorAll("polygon")) line.setAttribute("points", polygon);
  }

  /** The picture is shown otherwise from now on. */
  refit(fit: Fit): void {
    if (this.shown) this.show(this.shown.points, this.shown.picture, fit);
  }

  hide(): void {
    this.shown = null;
    for (const line of this.drawing.querySelectorAll("polygon")) line.removeAttribute("points");
  }
}
