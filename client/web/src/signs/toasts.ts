/**
 * Short messages in the corner. What goes on is told until it ends, and problems until they are dismissed or many others
 * have come; the rest goes by itself unless it is being read.
 */

import { words } from "../words/words";

const LIFE_MS = 8000;
/** Beside those of what goes on. */
const MOST = 4;

/** Something that goes on, and is told of until it ends. */
export interface Task {
  /** The part that is done, 0 to 1. */
  progress: (part: number) => void;
  end: () => void;
}

export class Toasts {
  private readonly region: HTMLElement;
  /** Notices so far. */
  private notices = 0;

  constructor(region: HTMLElement) {
    this.region = region;
  }

  /** Stays. Of several `about` the same, as while a slider is dragged through what is refused, the newest. */
  problem(text: string, about = text): void {
    this.add(text, "problem", about);
  }

  /** Goes by itself; what is returned takes it away earlier. */
  note(text: string): () => void {
    const toast = this.add(text, "note");
    fade(toast);
    return () => toast.remove();
  }

  /** Stays until what it tells of is done: what is returned takes it away then. */
  notice(text: string): () => void {
    this.notices += 1;
    const toast = lasting(this.add(text, "note", `notice ${this.notices}`)); // another of the same text goes on by itself
    return () => toast.remove();
  }

  /** What was found in a file; goes by itself. */
  finding(text: string): void {
    fade(this.add(text, "finding"));
  }

  /** Stays until it ends; the button is there to end it sooner. */
  task(text: string, label: string, act: () => void): Task {
    const toast = lasting(this.add(text, "task"));
    const bar = document.createElement("progress");
    bar.max = 1;
    bar.setAttribute("aria-label", text);
    const button = toast.querySelector("button");
    if (button) Object.assign(button, { className: "command", textContent: label, onclick: act, ariaLabel: null });
    toast.querySelector("p")?.append(bar);
    return {
      progress: (part) => {
        bar.value = Math.min(part, 1);
      },
      end: () => toast.remove(),
    };
  }

  private add(text: string, kind: "problem" | "note" | "finding" | "task", about = text): HTMLElement {
    for (const old of [...this.region.children]) {
      if (old instanceof HTMLElement && old.dataset.about === about) old.remove();
    }
    const passing = [...this.region.children].filter(
      (other) => other instanceof HTMLElement && !("lasts" in other.dataset),
    );
    for (const old of passing.slice(0, Math.max(0, passing.length - MOST + 1))) old.remove();
    const toast = document.createElement("div");
    toast.classList.add("toast", "sheet", kind);
    toast.dataset.about = about;
    if (kind === "problem") toast.setAttribute("role", "alert");
    const said = document.createElement("p");
    said.className = "toast-words";
    said.textContent = text;
    const dismiss = document.createElement("button");
    dismiss.type = "button";
    dismiss.className = "toast-dismiss";
    dismiss.textContent = "\u00d7";
    dismiss.setAttribute("aria-label", words.connection.dismiss);
    dismiss.onclick = () => toast.remove();
    toast.append(said, dismiss);
    this.region.append(toast);
    return toast;
  }
}

/** Others that come do not take it away. */
function lasting(toast: HTMLElement): HTMLElement {
  toast.dataset.lasts = "";
  return toast;
}

/** Take it away in a while; while the pointer rests on it, or a key is in it, time does not count. */
function fade(toast: HTMLElement): void {
  let timer: ReturnType<typeof setTimeout>;
  const start = () => {
    clearTimeout(timer);
    timer = setTimeout(() => toast.remove(), LIFE_MS);
  };
  for (const name of ["pointerenter", "focusin"]) toast.addEventListener(name, () => clearTimeout(timer));
  for (const name of ["pointerleave", "focusout"]) toast.addEventListener(name, start);
  start();
}
