/** Which stone this viewer has chosen: asks what is at a point, and where the chosen stone is in each picture. */

import type { Notice, Outline, Outlined, Pick, Picked } from "@culet/protocol/messages";

export interface ChosenListener {
  ask: (question: Pick | Outline) => void;
  /** Another stone is chosen, or none. */
  chosen: (id: string | null) => void;
  /** Where its outline is; null: nowhere, or not known. */
  outline: (points: readonly number[] | null) => void;
}

/** A question that was not answered for so long, in ms, is asked again. */
const PATIENCE_MS = 1000;

export class ChosenStone {
  private readonly listener: ChosenListener;
  private stone: string | null = null;
  private ids: readonly string[] = [];
  private number = 0;
  private told: ((id: string | null) => void) | undefined;
  /** Of the picture that is shown. */
  private step: number | null = null;
  private known: { stone: string; step: number } | null = null;
  private asked: { stone: string; step: number; time: number } | null = null;

  constructor(listener: ChosenListener) {
    this.listener = listener;
  }

  get id(): string | null {
    return this.stone;
  }

  /** A click or tap: x to the right and y up from the picture's centre, in halves of its height. Whoever asks may be
   *  told what was there, unless something else is picked meanwhile. */
  pick(x: number, y: number, told?: (id: string | null) => void): void {
    this.number += 1;
    this.told = told;
    this.listener.ask({ type: "pick", number: this.number, x, y });
  }

  choose(id: string | null): void {
    if (id === this.stone) return;
    this.stone = id;
    this.known = this.asked = null;
    this.listener.outline(null);
    this.listener.chosen(id);
    this.look(performance.now());
  }

  /** The picture of a step is on the screen, at a time in ms. */
  shown(step: bigint, time: number): void {
    this.step = Number(step);
    this.look(time);
  }

  /** The scene changed: these stones there are. One that was just added may be chosen before it is there. */
  there(ids: readonly string[]): void {
    const gone = this.stone !== null && this.ids.includes(this.stone) && !ids.includes(this.stone);
    this.ids = ids;
    if (gone) this.choose(null);
  }

  heard(notice: Notice): void {
    if (notice.type === "picked") this.picked(notice);
    else if (notice.type === "outlined") this.outlined(notice);
  }

  private picked({ number, stone }: Picked): void {
    if (number !== this.number) return; // an earlier click's answer comes too late
    this.choose(stone);
    this.told?.(stone);
    this.told = undefined;
  }

  private outlined({ stone, step, points }: Outlined): void {
    if (stone !== this.stone) return;
    this.asked = null;
    this.known = { stone, step };
    this.listener.outline(points.length > 0 ? points : null);
    this.look(performance.now());
  }

  /** One question at a time: in a picture that moves the outline follows as fast as the answers come. */
  private look(time: number): void {
    const { stone, step, known, asked } = this;
    if (stone === null || step === null || (known?.stone === stone && known.step === step)) return;
    if (asked && time - asked.time < PATIENCE_MS) return;
    this.asked = { stone, step, time };
    this.listener.ask({ type: "outline", stone, step });
  }
}
