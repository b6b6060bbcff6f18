/** Buttons of one kind side by side, with what is common to them before them. */

import { Command } from "./command";

export class Row {
  readonly element = document.createElement("div");
  private readonly buttons = document.createElement("div");

  constructor(label: string) {
    const text = document.createElement("span");
    text.textContent = label;
    text.setAttribute("aria-hidden", "true"); // each button's own name says it
    this.element.classList.add("control", "row");
    this.buttons.className = "buttons";
    this.element.append(text, this.buttons);
  }

  /** `said` is seen, in its row; `name` says all, to those who cannot see the row. */
  add(said: string, name: string, act: () => void, key = ""): Command {
    const button = new Command(said, act, key).name(name);
    this.buttons.append(button.element);
    return button;
  }
}
