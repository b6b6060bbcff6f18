/** A colour, as the browser's own dialogue gives it. */

import { Control, freshId } from "./control";

export class Colour extends Control<string> {
  private readonly box = document.createElement("input");

  constructor(label: string) {
    super(label, "colour");
    this.box.type = "color";
    this.box.id = freshId();
    this.text.htmlFor = this.box.id;
    this.element.append(this.box);
    this.box.oninput = () => this.tellInput();
    this.box.onchange = () => this.tellSettled();
  }

  /** `#rrggbb`, as sRGB encodes it. */
  get value(): string {
    return this.box.value;
  }

  override set value(value: string) {
    if (this.box.value !== value) this.box.value = value; // an open dialogue is told only of news
  }

  protected get fields(): readonly HTMLInputElement[] {
    return [this.box];
  }
}
