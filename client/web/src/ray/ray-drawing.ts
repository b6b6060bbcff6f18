/** The lines of a ray over the picture: one for each chain, which add up to white while they are together. */

import { letterbox, type PictureSize } from "../picture/picture-size";
import type { Chain } from "../session/answers";
import type { Line } from "./carrying";
import type { PicturePoint, Projection } from "./projection";

const NAMESPACE = "http://www.w3.org/2000/svg";
/** Weight below which a line is not drawn: it would be all but black. */
const FAINT = 1e-3;

export class RayDrawing {
  private readonly drawing = document.createElementNS(NAMESPACE, "svg");
  private readonly ground = document.createElementNS(NAMESPACE, "g");
  private readonly light = document.createElementNS(NAMESPACE, "g");
  private readonly marks = document.createElementNS(NAMESPACE, "g");

  /** Over the picture, and under all that lies over that. */
  constructor(after: Element) {
    this.drawing.id = "ray";
    this.drawing.setAttribute("aria-hidden", "true"); // the table says it all
    this.drawing.setAttribute("preserveAspectRatio", "none");
    this.ground.classList.add("ground");
    this.light.classList.add("light");
    this.marks.classList.add("marks");
    this.drawing.append(this.ground, this.light, this.marks);
    after.after(this.drawing);
  }

  /** The canvas is so large, and shows a picture of that shape. */
  show(
    lines: readonly Line[],
    chains: readonly Chain[],
    projection: Projection,
    picture: PictureSize,
    canvas: PictureSize,
    chosen: number | null,
  ): void {
    const { x, y, width, height } = letterbox(picture, canvas);
    this.drawing.setAttribute("viewBox", `0 0 ${canvas.width} ${canvas.height}`);
    const at = ([right, up]: PicturePoint) => [
      x + width / 2 + (height / 2) * right,
      y + height / 2 - (height / 2) * up,
    ];
    const ground: SVGElement[] = [];
    const light: SVGElement[] = [];
    const marks: SVGElement[] = [];
    for (const { step, pass, from, to } of lines) {
      const isChosen = step.number === chosen;
      if (Math.max(pass.weight, pass.weight_before) < FAINT && !isChosen) continue;
      const seen = projection.line(from, to);
      if (!seen) continue;
      const [[x1 = 0, y1 = 0], [x2 = 0, y2 = 0]] = [at(seen[0]), at(seen[1])];
      const ends = { x1, y1, x2, y2 };
      ground.push(shape("line", { ...ends, class: isChosen ? "chosen" : "" }));
      const drawn = shape("line", { ...ends, class: isChosen ? "chosen" : "" });
      drawn.style.stroke = colourOf(pass.chain === null ? null : chains[pass.chain]);
      drawn.style.opacity = String(isChosen ? 1 : 0.3 + 0.7 * Math.sqrt(Math.min(Math.max(pass.weight_before, 0), 1)));
      light.push(drawn);
      if (isChosen)
        marks.push(shape("circle", { cx: x2, cy: y2, r: 5 * (canvas.width / this.drawing.clientWidth || 1) }));
    }
    this.ground.replaceChildren(...ground);
    this.light.replaceChildren(...light);
    this.marks.replaceChildren(...marks);
  }

  clear(): void {
    for (const group of [this.ground, this.light, this.marks]) group.replaceChildren();
  }

  remove(): void {
    this.drawing.remove();
  }
}

function shape(name: "line" | "circle", attributes: Record<string, number | string>): SVGElement {
  const made = document.createElementNS(NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  return made;
}

/** Of a chain; white before a stone parts them. */
export function colourOf(chain: Chain | null | undefined): string {
  const [red, green, blue] = (chain?.colour ?? [1, 1, 1]).map((linear) => Math.round(255 * encoded(linear)));
  return `rgb(${red} ${green} ${blue})`;
}

/** IEC 61966-2-1. */
function encoded(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}
