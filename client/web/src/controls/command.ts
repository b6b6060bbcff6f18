/** A button, with the key that does the same. */

export class Command {
  readonly element = document.createElement("button");
  private readonly text = document.createElement("span");
  private called: HTMLElement | null = null;

  constructor(label: string, act: () => void, key = "") {
    this.element.type = "button";
    this.element.className = "command";
    this.element.onclick = () => this.idle && act();
    this.text.textContent = label;
    this.element.append(this.text);
    if (key) this.element.append(keyMark(key));
  }

  label(text: string): void {
    if (this.text.textContent !== text) this.text.textContent = text;
  }

  /** What the button is called, if what is seen of it is less; a tooltip says the same. */
  name(text: string): this {
    if (!this.called) {
      this.called = document.createElement("span");
      this.called.className = "for-screen-readers";
      this.text.setAttribute("aria-hidden", "true");
      this.element.prepend(this.called);
    }
    this.called.textContent = this.element.title = text;
    return this;
  }

  /** What was asked for is on its way: the button keeps the focus, and does nothing. */
  busy(on: boolean): this {
    this.element.setAttribute("aria-busy", String(on));
    this.element.setAttribute("aria-disabled", String(on));
    return this;
  }

  private get idle(): boolean {
    return this.element.getAttribute("aria-busy") !== "true";
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

/** A key as it is printed: drawn by the style sheet, as no part of the button's name; screen readers have the list of keys. */
export function keyMark(key: string): HTMLElement {
  const mark = document.createElement("kbd");
  mark.dataset.key = key;
  mark.setAttribute("aria-hidden", "true");
  return mark;
}
