/** Short messages in the corner. Problems stay until they are dismissed, the rest goes by itself unless it is being read. */

import { words } from "../words/words";

const LIFE_MS = 8000;
const MOST = 4;

export class Toasts {
  private readonly region: HTMLElement;

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

  /** What was found in a file; goes by itself. */
  finding(text: string): void {
    fade(this.add(text, "finding"));
  }

  private add(text: string, kind: "problem" | "note" | "finding", about = text): HTMLElement {
    for (const old of [...this.region.children]) {
      if (old instanceof HTMLElement && old.dataset.about === about) old.remove();
    }
    while (this.region.children.length >= MOST) this.region.firstElementChild?.remove();
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
