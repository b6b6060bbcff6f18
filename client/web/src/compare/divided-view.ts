/**
 * Two designs beside each other: over the left part of the picture lies that of the kept design, under the same camera and
 * light, up to a divider that is dragged. Loaded when it is first asked for.
 */

import "./divided.css";
import { element } from "../page";
import { sizeWithin } from "../picture/picture-size";
import * as rest from "../session/rest";
import { words } from "../words/words";
import type { DivisionWorld } from "./division";

/** ms for which the picture stays as it is before the other one is asked for. */
const PATIENCE_MS = 300;
/** Percent of the width. */
const MIDDLE = 50;

export class DividedView {
  private readonly world: DivisionWorld;
  private readonly room = document.createElement("section");
  private readonly picture = document.createElement("img");
  private readonly divider = document.createElement("input");
  /** Of the kept design's side. */
  private readonly caption: HTMLElement;
  private step: bigint | null = null;
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private giveUp = new AbortController();

  constructor(world: DivisionWorld) {
    this.world = world;
    const { room, picture, divider } = this;
    room.id = "divided";
    picture.alt = words.compare.keptPicture;
    picture.hidden = true;
    Object.assign(divider, { type: "range", min: "0", max: "100", step: "any", value: String(MIDDLE) });
    divider.setAttribute("aria-label", words.compare.divider);
    divider.dataset.arrowKeys = "";
    divider.oninput = () => this.divide();
    // By its own steps: `any` has none that a key could go by.
    divider.onkeydown = (event) => {
      const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      divider.value = String(divider.valueAsNumber + by);
      this.divide();
    };
    const [kept, shown] = [words.compare.keptSide, words.compare.shownSide].map((text) => {
      const caption = document.createElement("span");
      caption.textContent = text;
      return caption;
    }) as [HTMLElement, HTMLElement];
    this.caption = kept;
    const line = document.createElement("i");
    room.append(picture, kept, shown, line, divider);
    this.divide();
    element("outline", SVGSVGElement).after(room);
    this.changed();
  }

  /** Another picture is on the screen, or another design is kept. */
  shown(): void {
    const step = this.world.visit.lastFrame?.step ?? null;
    if (step !== this.step) this.changed();
  }

  /** What lies beside is of something else by now: ask for it once the picture stays as it is. */
  changed(): void {
    clearTimeout(this.waiting);
    this.giveUp.abort();
    this.picture.hidden = true;
    this.caption.textContent = words.compare.keptSide;
    this.step = this.world.visit.lastFrame?.step ?? null;
    this.waiting = setTimeout(() => this.world.complaints.attempt(() => this.ask()), PATIENCE_MS);
  }

  close(): void {
    clearTimeout(this.waiting);
    this.giveUp.abort();
    this.forget();
    this.room.remove();
  }

  private divide(): void {
    this.room.style.setProperty("--at", String(this.divider.valueAsNumber / 100));
    this.divider.setAttribute("aria-valuetext", words.compare.at(Math.round(this.divider.valueAsNumber)));
  }

  /** A quick picture first, then a fine one. */
  private async ask(): Promise<void> {
    const { visit, comparison } = this.world;
    const { session, lastFrame } = visit;
    if (session === null || !lastFrame) return;
    this.giveUp = new AbortController();
    const { signal } = this.giveUp;
    try {
      const { step } = lastFrame;
      const beside = comparison.beside(await rest.sceneShown(session, step), visit.scene);
      if (!beside || signal.aborted) return;
      const size = sizeWithin(lastFrame, this.world.canvas); // a frame in motion has fewer pixels
      this.caption.textContent = words.compare.keptWaits; // until then what is shown is at both sides
      for (const samples of [1, null]) {
        const blob = await rest.beside(session, { ...beside, step, ...size }, samples, signal);
        if (signal.aborted) return;
        this.forget();
        this.picture.src = URL.createObjectURL(blob);
        await this.picture.decode();
        if (signal.aborted) return;
        this.picture.hidden = false;
        this.caption.textContent = words.compare.keptSide;
      }
    } catch (error) {
      if (signal.aborted) return; // what has its place by now says how that is
      this.caption.textContent = words.compare.keptSide;
      throw error;
    }
  }

  private forget(): void {
    URL.revokeObjectURL(this.picture.src);
  }
}
