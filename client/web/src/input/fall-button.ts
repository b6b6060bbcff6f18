/** The round button in the picture that lets the stone fall, or pauses the fall. */

import type { ViewState } from "../session/view-state";
import { hasStone } from "../stones/stones";
import { worded } from "../words/wording";
import { words } from "../words/words";
import { actionNamed, labelWithKey } from "./actions";

const { fall: FALL, pause: PAUSE } = words.fallButton;

/** What the button does next, or null if there is no stone. */
export function fallLabel({ scene, falling, asleep }: Pick<ViewState, "scene" | "falling" | "asleep">): string | null {
  if (!hasStone(scene)) return null;
  return worded(falling && !asleep ? PAUSE : FALL, scene);
}

export class FallButton {
  private readonly button: HTMLButtonElement;

  constructor(button: HTMLButtonElement, press: () => void) {
    this.button = button;
    button.onclick = press;
  }

  update(state: ViewState): void {
    const label = fallLabel(state);
    this.button.hidden = label === null;
    if (label === null) return;
    const { key } = actionNamed("fall");
    this.button.setAttribute("aria-label", label);
    this.button.title = labelWithKey({ label, key });
    this.button.classList.toggle("falling", label === PAUSE);
  }
}
