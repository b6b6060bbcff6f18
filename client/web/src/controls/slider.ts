/** A number: a range to drag, and a box to type it into. */

import { Control, freshId } from "./control";

export interface Ends {
  least: number;
  most: number;
  step: number;
  /** Of the number that is shown. */
  decimals: number;
}

/** Told of a typed number that is beyond the ends, and of what it became. */
export type Clamped = (typed: number, taken: number) => void;

/** The number nearest to a value that a slider can be at. */
export function within(value: number, { least, most, step }: Ends): number {
  const steps = Math.round((value - least) / step);
  return Number(Math.min(Math.max(least + steps * step, least), most).toFixed(10));
}

/** As it is typed: at most so many decimals. */
export function shortened(value: number, { decimals }: Pick<Ends, "decimals">): string {
  return String(Number(value.toFixed(decimals)));
}

export class Slider extends Control<number> {
  private ends: Ends;
  private readonly range = document.createElement("input");
  private readonly box = document.createElement("input");
  private now = Number.NaN;

  constructor(label: string, ends: Ends, clamped: Clamped) {
    super(label, "slider");
    this.ends = ends;
    const { range, box } = this;
    Object.assign(range, { type: "range" });
    Object.assign(box, { type: "number", step: "any", inputMode: "decimal", id: freshId() });
    this.between(ends);
    this.text.htmlFor = box.id;
    this.text.id = freshId();
    range.setAttribute("aria-labelledby", this.text.id);
    this.element.append(range, box);
    range.oninput = () => {
      this.take(range.valueAsNumber);
      this.tellInput();
    };
    range.onchange = () => this.tellSettled();
    box.onchange = () => this.typed(clamped);
    box.onkeydown = (event) => this.stepped(event);
  }

  /** Other ends. The value stays, and nobody is told. */
  between(ends: Ends): this {
    this.ends = ends;
    const { range, box } = this;
    for (const input of [range, box]) Object.assign(input, { min: String(ends.least), max: String(ends.most) });
    range.step = String(ends.step);
    if (Number.isFinite(this.now)) range.value = String(this.now);
    return this;
  }

  get value(): number {
    return this.now;
  }

  override set value(value: number) {
    if (document.activeElement !== this.box || value !== this.now) this.take(value);
  }

  protected get fields(): readonly HTMLInputElement[] {
    return [this.range, this.box];
  }

  private take(value: number): void {
    this.now = value;
    this.range.value = String(value);
    this.range.setAttribute("aria-valuetext", shortened(value, this.ends));
    this.box.value = Number.isFinite(value) ? shortened(value, this.ends) : "";
  }

  private typed(clamped: Clamped): void {
    const typed = this.box.valueAsNumber;
    if (!Number.isFinite(typed)) {
      this.take(this.now);
      return;
    }
    const taken = Math.min(Math.max(typed, this.ends.least), this.ends.most);
    if (taken !== typed) clamped(typed, taken);
    this.choose(taken);
  }

  /** Arrow keys go by the slider's step: the browser would go by 1, since any number may be typed. Enter takes what was
   * typed and goes back to the range, which leaves letters to the page. */
  private stepped(event: KeyboardEvent): void {
    if (event.key === "Enter") this.range.focus();
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (sign === undefined) return;
    event.preventDefault();
    this.choose(within(this.now + sign * this.ends.step, this.ends));
  }

  private choose(value: number): void {
    this.take(value);
    this.tellInput();
    this.tellSettled();
  }
}
