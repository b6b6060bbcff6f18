/** Short messages in the corner. Problems stay until they are dismissed, the rest goes by itself. */

const LIFE_MS = 6000;
const MOST = 4;

export class Toasts {
  private readonly region: HTMLElement;

  constructor(region: HTMLElement) {
    this.region = region;
  }

  problem(text: string): void {
    this.add(text, "problem");
  }

  /** Goes by itself; what is returned takes it away earlier. */
  note(text: string): () => void {
    const toast = this.add(text, "note");
    const timer = setTimeout(() => toast.remove(), LIFE_MS);
    return () => {
      clearTimeout(timer);
      toast.remove();
    };
  }

  /** Stays until dismissed, but is no problem. */
  finding(text: string): void {
    this.add(text, "finding");
  }

  private add(text: string, kind: "problem" | "note" | "finding"): HTMLElement {
    for (const old of [...this.region.children]) {
      if (old.firstChild?.textContent === text) old.remove(); // the same again: shown once, as the newest
    }
    while (this.region.children.length >= MOST) this.region.firstElementChild?.remove();
    const toast = document.createElement("div");
    toast.className = `toast ${kind}`;
    if (kind === "problem") toast.setAttribute("role", "alert");
    const words = document.createElement("p");
    words.className = "toast-words";
    words.textContent = text;
    const dismiss = document.createElement("button");
    dismiss.type = "button";
    dismiss.className = "toast-dismiss";
    dismiss.textContent = "\u00d7";
    dismiss.setAttribute("aria-label", "Dismiss");
    dismiss.onclick = () => toast.remove();
    toast.append(words, dismiss);
    this.region.append(toast);
    return toast;
  }
}
