/** A button. */

export class Command {
  readonly element = document.createElement("button");

  constructor(label: string, act: () => void) {
    this.element.type = "button";
    this.element.className = "command";
    this.element.textContent = label;
    this.element.onclick = act;
  }

  label(text: string): void {
    if (this.element.textContent !== text) this.element.textContent = text;
  }

  show(shown: boolean): this {
    this.element.hidden = !shown;
    return this;
  }

  enable(enabled: boolean): this {
    this.element.disabled = !enabled;
    return this;
  }
}
