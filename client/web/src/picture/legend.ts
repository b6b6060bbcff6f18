/** What an instrument's colours mean, and from where the stone is seen: over the picture, in its lower left corner. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, text } from "../json";
import { directionOf, tiltOf } from "../panel/tilt";
import { words } from "../words/words";

export interface LegendLine {
  text: string;
  /** A class of the patch before the text, by its colour. */
  colour?: "red" | "green" | "blue" | "black" | "white";
}

/** Degrees about the vertical that the observer's head fills, where the scene does not say. */
export const HEADS: Readonly<Record<string, number>> = { aset: 15, "ideal-scope": 10 };
/** Degrees of tilt that are none. */
const FACE_UP = 0.05;

/** The instrument under which the scene is seen; empty without one. */
export function instrumentOf(scene: JsonObject | null): string {
  const sky = part(scene, "environment");
  const image = sky.kind === "image" ? text(sky.image, "") : "";
  return image in HEADS ? image : "";
}

export function headOf(scene: JsonObject | null): number {
  return number(part(scene, "environment").head_degrees, HEADS[instrumentOf(scene)] ?? Number.NaN);
}

/** Lines for a scene; none for one without an instrument and without parallel rays. */
export function legendOf(scene: JsonObject | null): LegendLine[] {
  const instrument = instrumentOf(scene);
  if (instrument === "" && part(scene, "camera").kind !== "orthographic") return [];
  return [...coloursOf(instrument, 90 - headOf(scene)), { text: tiltText(scene) }];
}

function coloursOf(instrument: string, edge: number): LegendLine[] {
  const said = words.legend;
  if (instrument === "aset") {
    return [
      { text: said.above(45, edge), colour: "red" },
      { text: said.aside(45), colour: "green" },
      { text: said.head(edge), colour: "blue" },
      { text: said.leak, colour: "black" },
    ];
  }
  if (instrument === "") return [];
  return [
    { text: said.back(edge), colour: "red" },
    { text: said.head(edge), colour: "black" },
    { text: said.leak, colour: "white" },
  ];
}

function tiltText(scene: JsonObject | null): string {
  const tilt = tiltOf(scene);
  return tilt < FACE_UP ? words.legend.faceUp : words.legend.tilted(tilt, Math.round(directionOf(scene) ?? 0) % 360);
}

export class Legend {
  private readonly list: HTMLElement;
  private shown = "";

  constructor(list: HTMLElement) {
    this.list = list;
  }

  update(scene: JsonObject | null): void {
    const lines = legendOf(scene);
    const said = JSON.stringify(lines);
    if (said === this.shown) return;
    this.shown = said;
    this.list.hidden = lines.length === 0;
    this.list.replaceChildren(...lines.map(itemOf));
  }
}

function itemOf({ text: said, colour }: LegendLine): HTMLLIElement {
  const item = document.createElement("li");
  item.textContent = said;
  if (colour) item.className = colour;
  return item;
}
