/** What is so or not. */

import { Control, freshId } from "./control";

export class Toggle extends Control<boolean> {
  private readonly box = document.createElement("input");

  constructor(label: string) {
    super(label, "toggle");
    this.box.type = "checkbox";
    this.box.id = freshId();
    this.text.htmlFor = this.box.id;
    this.element.append(this.box);
    this.box.onchange = () => {
      this.tellInput();
      this.tellSettled();
    };
  }

  get value(): boolean {
    return this.box.checked;
  }

  override set value(value: boolean) {
    this.box.checked = value;
  }

  protected get fields(): readonly HTMLInputElement[] {
    return [this.box];
  }
}
