/** A part of the panel under a heading, which folds it. */

import { freshId } from "./control";

/** Level of the heading in the page. */
export type Level = 1 | 2 | 3;

/** What can be put into a section. */
export interface SectionPart {
  readonly element: HTMLElement;
}

export class Section {
  readonly element = document.createElement("section");
  readonly body = document.createElement("div");
  private readonly level: Level;
  private readonly button = document.createElement("button");
  private readonly folding: ((open: boolean) => void)[] = [];

  constructor(title: string, level: Level = 2) {
    this.level = level;
    const heading = document.createElement(`h${level}`);
    this.body.id = freshId();
    this.body.className = "body";
    this.button.type = "button";
    this.button.setAttribute("aria-controls", this.body.id);
    this.button.onclick = () => this.fold(this.open);
    heading.append(this.button);
    this.element.className = "section";
    this.element.append(heading, this.body);
    this.title(title);
    this.fold(false);
  }

  get open(): boolean {
    return !this.body.hidden;
  }

  title(text: string): void {
    if (this.button.textContent !== text) this.button.textContent = text;
  }

  fold(folded: boolean): this {
    this.body.hidden = folded;
    this.button.setAttribute("aria-expanded", String(!folded));
    for (const told of this.folding) told(!folded);
    return this;
  }

  onFold(listener: (open: boolean) => void): void {
    this.folding.push(listener);
  }

  show(shown: boolean): this {
    this.element.hidden = !shown;
    return this;
  }

  add<P extends SectionPart>(part: P): P {
    this.body.append(part.element);
    return part;
  }

  /** A section in this one, a heading's level deeper. */
  section(title: string): Section {
    return this.add(new Section(title, this.level === 1 ? 2 : 3));
  }
}
