/** A list of which one entry is chosen. It keeps the focus, whatever is chosen, offered or shown. */

import { Control, freshId } from "./control";

export interface Option<T> {
  label: string;
  value: T;
  /** What it means. */
  summary?: string;
}

export class Choice<T extends string | number> extends Control<T> {
  private readonly list = document.createElement("select");
  private options: readonly Option<T>[] = [];
  private now: T;
  private always = "";
  private readonly foreign = document.createElement("option");

  constructor(label: string, options: readonly Option<T>[], value: T) {
    super(label, "choice");
    this.now = value;
    this.list.id = freshId();
    this.text.htmlFor = this.list.id;
    this.foreign.disabled = true;
    this.element.append(this.list);
    this.offer(options);
    this.list.onchange = () => {
      const option = this.options[this.list.selectedIndex];
      if (!option) return;
      this.now = option.value;
      this.explain();
      this.tellInput();
      this.tellSettled();
    };
  }

  get value(): T {
    return this.now;
  }

  /** A value that is not offered, such as a sky of a preset's own, is shown by its name, and cannot be chosen again. */
  override set value(value: T) {
    this.now = value;
    this.foreign.remove();
    const chosen = this.options.findIndex((option) => option.value === value);
    if (chosen < 0 && value !== "") {
      this.foreign.textContent = this.foreign.value = String(value);
      this.list.append(this.foreign);
      this.list.selectedIndex = this.options.length;
    } else this.list.selectedIndex = chosen;
    this.explain();
  }

  /** Offer these from now on. */
  offer(options: readonly Option<T>[]): void {
    this.options = options;
    this.list.replaceChildren(
      ...options.map(({ label, value, summary }) => {
        const option = document.createElement("option");
        Object.assign(option, { textContent: label, value: String(value), title: summary ?? "" });
        return option;
      }),
    );
    this.value = this.now;
  }

  override hint(text: string): this {
    this.always = text;
    this.explain();
    return this;
  }

  protected get fields(): readonly HTMLSelectElement[] {
    return [this.list];
  }

  /** Of the list, and of what is chosen: tooltips of options are not shown everywhere. */
  private explain(): void {
    const chosen = this.options[this.list.selectedIndex]?.summary;
    super.hint([this.always, chosen].filter(Boolean).join("\n"));
  }
}
