/** The table beside a drawn ray: where its light comes from, and its steps, through which the arrow keys go. */

import type { Path, Step } from "../session/answers";
import { reasonOf } from "../signs/complaints";
import { words } from "../words/words";
import { colourOf } from "./ray-drawing";
import { angleText, factsOf, happensText, lightText, sentencesOf, shareText } from "./ray-text";

export interface RayCardListener {
  chosen: (step: number) => void;
  close: () => void;
}

export class RayCard {
  private readonly card = document.createElement("section");
  private readonly status = document.createElement("div");
  private readonly table = document.createElement("table");
  private readonly facts = document.createElement("dl");
  private readonly listener: RayCardListener;
  private rows: HTMLTableRowElement[] = [];
  private path: Path | null = null;
  private millimetres = 1;

  constructor(room: HTMLElement, listener: RayCardListener) {
    this.listener = listener;
    this.card.id = "ray-card";
    this.card.className = "sheet";
    this.card.tabIndex = -1;
    this.card.dataset.arrowKeys = ""; // they walk through the ray, and move nothing while it is waited for
    const heading = document.createElement("h2");
    heading.id = "ray-title";
    heading.textContent = words.ray.title;
    this.card.setAttribute("aria-labelledby", heading.id);
    const close = document.createElement("button");
    close.type = "button";
    close.textContent = words.ray.close;
    close.onclick = () => listener.close();
    this.status.setAttribute("role", "status");
    this.status.append(paragraph(words.ray.how));
    this.table.setAttribute("role", "grid");
    this.table.setAttribute("aria-label", words.ray.steps);
    this.table.onkeydown = (event) => this.walk(event);
    this.facts.tabIndex = -1;
    const head = document.createElement("header");
    head.append(heading, close);
    this.card.append(head, this.status, this.table, this.facts);
    room.append(this.card);
  }

  /** An answer is waited for. */
  wait(): void {
    this.card.setAttribute("aria-busy", "true");
    if (!this.path) this.status.replaceChildren(paragraph(words.ray.waits));
  }

  show(path: Path, millimetres: number): void {
    this.path = path;
    this.millimetres = millimetres;
    this.card.removeAttribute("aria-busy");
    this.status.replaceChildren(...sentencesOf(path).map(paragraph));
    const head = this.table.createTHead();
    head.replaceChildren(rowOf("th", words.ray.columns));
    const body = this.table.tBodies[0] ?? this.table.createTBody();
    this.rows = path.steps.map((step) => this.row(step, path));
    body.replaceChildren(...this.rows);
    this.choose(0);
  }

  fail(error: unknown): void {
    this.card.removeAttribute("aria-busy");
    this.status.replaceChildren(paragraph(reasonOf(error)));
  }

  /** The focus goes to the step that is chosen, from where the arrow keys go on, or to the card while it has none. */
  focus(): void {
    const step = this.rows.find((row) => row.tabIndex === 0);
    (step ?? this.card).focus({ preventScroll: true });
  }

  /** Whether it has the focus, and not a control in it. */
  get focused(): boolean {
    return document.activeElement === this.card;
  }

  remove(): void {
    this.card.remove();
  }

  private row(step: Step, path: Path): HTMLTableRowElement {
    const row = rowOf("td", [
      String(step.number),
      lightText(step, path),
      happensText(step, path),
      angleText(step),
      shareText(step),
    ]);
    const first = step.passes.length === 1 ? step.passes[0]?.chain : null;
    if (first !== null && first !== undefined) row.style.setProperty("--light", colourOf(path.chains[first]));
    row.style.setProperty("--depth", String(Math.min(depthOf(step, path.steps), 12)));
    row.onclick = () => {
      this.choose(step.number);
      row.focus({ preventScroll: true });
    };
    return row;
  }

  private choose(number: number): void {
    const step = this.path?.steps[number];
    if (!this.path || !step) {
      this.facts.replaceChildren();
      return;
    }
    for (const [place, row] of this.rows.entries()) {
      row.tabIndex = place === number ? 0 : -1;
      row.setAttribute("aria-selected", String(place === number));
    }
    this.rows[number]?.scrollIntoView({ block: "nearest" });
    this.facts.replaceChildren(
      ...factsOf(step, this.path, this.millimetres).flatMap(([name, value]) => {
        const [term, said] = [document.createElement("dt"), document.createElement("dd")];
        term.textContent = name;
        said.textContent = value;
        return [term, said];
      }),
    );
    const row = this.rows[number];
    if (row) row.ariaDescription = [...this.facts.children].map((each) => each.textContent).join(" ");
    this.listener.chosen(number);
  }

  private walk(event: KeyboardEvent): void {
    const now = this.rows.findIndex((row) => row.tabIndex === 0);
    const last = this.rows.length - 1;
    const parent = this.path?.steps[now]?.parent ?? now;
    const next = {
      ArrowDown: Math.min(now + 1, last),
      ArrowRight: Math.min(now + 1, last),
      ArrowUp: Math.max(now - 1, 0),
      ArrowLeft: parent,
      Home: 0,
      End: last,
    }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.choose(next);
    this.rows[next]?.focus({ preventScroll: true });
  }
}

/** How many steps lead to one. */
function depthOf(step: Step, steps: readonly Step[]): number {
  let [depth, at] = [0, step];
  while (at.parent !== null) {
    const before = steps[at.parent];
    if (!before) break;
    [depth, at] = [depth + 1, before];
  }
  return depth;
}

function paragraph(text: string): HTMLElement {
  const made = document.createElement("p");
  made.textContent = text;
  return made;
}

function rowOf(kind: "th" | "td", texts: readonly string[]): HTMLTableRowElement {
  const row = document.createElement("tr");
  for (const text of texts) {
    const cell = document.createElement(kind);
    if (cell.tagName === "TH") cell.scope = "col";
    cell.textContent = text;
    row.append(cell);
  }
  return row;
}
