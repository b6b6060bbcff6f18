/** What is common to the controls of the panel: native elements with a label, and words about them. */

import { keyMark } from "./command";

let made = 0;

/** An id that no other element of the page has. */
export function freshId(): string {
  made += 1;
  return `control-${made}`;
}

export type Listener<T> = (value: T) => void;

/** A labelled control that has a value. */
export abstract class Control<T> {
  readonly element = document.createElement("div");
  protected readonly text = document.createElement("label");
  private readonly inputs: Listener<T>[] = [];
  private readonly settlings: Listener<T>[] = [];

  protected constructor(label: string, kind: string) {
    this.element.className = `control ${kind}`;
    this.text.textContent = label;
    this.element.append(this.text);
  }

  /** A key does the same. */
  key(name: string): this {
    this.element.append(keyMark(name));
    return this;
  }

  abstract get value(): T;
  /** Show a value that the user did not choose; nobody is told. */
  abstract set value(value: T);

  /** Every value while it is being chosen. */
  onInput(listener: Listener<T>): this {
    this.inputs.push(listener);
    return this;
  }

  /** It was let go. */
  onSettled(listener: Listener<T>): this {
    this.settlings.push(listener);
    return this;
  }

  label(text: string): void {
    if (this.text.textContent !== text) this.text.textContent = text;
  }

  show(shown: boolean): this {
    this.element.hidden = !shown;
    return this;
  }

  enable(enabled: boolean): this {
    for (const input of this.fields) input.disabled = !enabled;
    return this;
  }

  /** What it means: see `Hints`. */
  hint(text: string): this {
    this.element.dataset.hint = text;
    for (const input of this.fields) input.setAttribute("aria-description", text);
    return this;
  }

  protected abstract get fields(): readonly (HTMLInputElement | HTMLSelectElement)[];

  protected tellInput(): void {
    for (const listener of this.inputs) listener(this.value);
  }

  protected tellSettled(): void {
    for (const listener of this.settlings) listener(this.value);
  }
}
