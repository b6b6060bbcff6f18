/** What an address asks of the page where it stands in another page: no interface, a turntable, another background. */

import type { Orbit } from "@culet/protocol/messages";
import { words } from "../words/words";

export interface Embedding {
  /** Panel, scenes, buttons and lines are shown. */
  ui: boolean;
  /** Degrees a second by which the camera goes about the stones, counter-clockwise seen from above; 0: it stands. */
  rotate: number;
  /** What an instrument's colours mean is said in the picture. */
  legend: boolean;
  /** Behind everything, of a session that is made: as a scene has it, such as #f4f1ea; null: as that scene has it. */
  background: string | null;
}

/** Degrees a second: a turn in a second. */
export const FASTEST = 360;

/** In an address # begins something else. */
const COLOUR = /^#?[0-9a-fA-F]{6}$/;

/** By the address' query; throws Error with words for whoever wrote that. */
export function embeddingOf(search: string): Embedding {
  const query = new URLSearchParams(search);
  const [ui, rotate] = [query.get("ui") ?? "1", query.get("rotate") ?? "0"];
  const legend = query.get("legend") ?? ui;
  const background = query.get("background");
  if (ui !== "0" && ui !== "1") throw new Error(words.address.ui(ui));
  if (legend !== "0" && legend !== "1") throw new Error(words.address.legend(legend));
  if (background !== null && !COLOUR.test(background)) throw new Error(words.address.background(background));
  const degrees = rotate.trim() === "" ? Number.NaN : Number(rotate);
  if (!(Math.abs(degrees) <= FASTEST)) {
    throw new Error(words.address.rotate(FASTEST, rotate));
  }
  return {
    ui: ui === "1",
    rotate: degrees,
    legend: legend === "1",
    background: background === null ? null : `#${background.replace("#", "")}`,
  };
}

/** The part of an address that asks for the same of a session that there is, to be put after another query. */
export function queryOf({ ui, rotate, legend }: Embedding): string {
  const said = legend === ui ? "" : `&legend=${legend ? 1 : 0}`;
  return `${ui ? "" : "&ui=0"}${rotate === 0 ? "" : `&rotate=${rotate}`}${said}`;
}

/**
 * What a page in a frame tells the page about it: that it shows a picture, or what is in its way, which may pass by
 * itself. Only to whom the server lets in, and nothing in it is to be kept secret.
 */
export type Told = { culet: "shown" } | { culet: "obstacle"; text: string; passes: boolean };

export function tellAround(told: Told): void {
  if (window.parent !== window) window.parent.postMessage(told, "*");
}

/** ms for which the turntable waits after somebody has turned the view. */
export const REST_MS = 3000;
/** ms for which the picture of the last turn is waited for: the last one of a view at rest has no other after it. */
const PATIENCE_MS = 100;
/** ms: of a longer pause between two pictures nothing is made up for, or the stone would jump. */
const LONGEST_MS = 250;

/** Turns the view from picture to picture, so that it is never ahead of what the server draws. */
export class Turntable {
  private readonly degrees: number;
  private readonly send: (turn: Orbit) => void;
  private turned: number | null = null;
  private shown = -1;
  private resting = Number.NEGATIVE_INFINITY;
  private stopped = false;

  /** `degrees` a second. */
  constructor(degrees: number, send: (turn: Orbit) => void) {
    this.degrees = degrees;
    this.send = send;
  }

  /** Of an animation frame, at its time in ms; `shown` counts the pictures so far. */
  turn(now: number, shown: number): void {
    const since = this.turned;
    if (this.degrees === 0 || this.stopped || now < this.resting) return;
    if (since !== null && shown === this.shown && now - since < PATIENCE_MS) return;
    this.turned = now;
    this.shown = shown;
    if (since === null) return;
    const radians = (this.degrees * Math.PI) / 180;
    this.send({ type: "orbit", target: "camera", yaw: (radians * Math.min(now - since, LONGEST_MS)) / 1000, pitch: 0 });
  }

  /** Somebody turns the view by hand at this time, ms: it stays with what that one looks at for a while. */
  rest(now: number): void {
    this.resting = now + REST_MS;
    this.turned = null;
  }

  /** Stop, or go on: what moves by itself has to be stopped by whoever is disturbed by that. */
  toggle(): void {
    this.stopped = !this.stopped;
    this.turned = null;
  }
}
