/**
 * How the window of somebody who only watches shows a picture of another shape than its own: all of it, or as large as
 * the window, its sides cut off. Kept in this browser.
 */

import { actionNamed, labelWithKey } from "../input/actions";
import { words } from "../words/words";
import type { Fit } from "./picture-size";

const KEPT = "culet.fit";

type Memory = Pick<Storage, "getItem" | "setItem">;

export class WindowFit {
  private readonly button: HTMLButtonElement;
  private readonly apply: (fit: Fit) => void;
  private readonly memory: () => Memory;
  private fit: Fit;

  /** `apply` has the picture shown so. */
  constructor(button: HTMLButtonElement, apply: (fit: Fit) => void, memory: () => Memory = () => localStorage) {
    this.button = button;
    this.apply = apply;
    this.memory = memory;
    this.fit = this.kept();
    button.onclick = () => this.toggle();
    this.show();
  }

  toggle(): void {
    this.fit = this.fit === "whole" ? "filled" : "whole";
    try {
      this.memory().setItem(KEPT, this.fit);
    } catch {
      // A browser that forbids to remember begins with the whole picture next time.
    }
    this.show();
  }

  /** Whether there is anything to choose: the picture has another shape than the window. */
  offer(differs: boolean): void {
    this.button.hidden = !differs;
  }

  private kept(): Fit {
    try {
      return this.memory().getItem(KEPT) === "filled" ? "filled" : "whole";
    } catch {
      return "whole";
    }
  }

  private show(): void {
    const label = this.fit === "whole" ? words.fit.fill : words.fit.whole;
    this.button.textContent = labelWithKey({ ...actionNamed("fit"), label });
    this.apply(this.fit);
  }
}
