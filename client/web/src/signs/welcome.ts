/** The line that tells on a first visit what to do, and goes once something was done. */

import { words } from "../words/words";

const VISITED = "culet.visited";

export interface Memory {
  getItem: (key: string) => string | null;
  setItem: (key: string, value: string) => void;
}

/** What to do first, with a mouse and keys or with fingers. */
export function firstSteps(fingers: boolean): string {
  return fingers ? words.welcome.fingers : words.welcome.mouse;
}

/** Whether this is the first visit, which is remembered; a browser that forbids to remember has visited. */
export function isFirst(memory: () => Memory): boolean {
  try {
    const first = memory().getItem(VISITED) === null;
    if (first) memory().setItem(VISITED, "1");
    return first;
  } catch {
    return false;
  }
}

export class Welcome {
  private readonly line: HTMLElement;

  constructor(line: HTMLElement) {
    this.line = line;
  }

  /** To be shown with the first picture. */
  show(): void {
    if (!isFirst(() => localStorage)) return;
    this.line.textContent = firstSteps(matchMedia("(pointer: coarse)").matches);
    this.line.hidden = false;
    const done = new AbortController();
    const go = () => {
      this.line.hidden = true;
      done.abort();
    };
    for (const act of ["pointerdown", "keydown", "wheel"] as const) {
      window.addEventListener(act, go, { capture: true, passive: true, signal: done.signal });
    }
  }
}
