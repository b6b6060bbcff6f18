/** The panel's buttons that undo an edit and make one again. */

import { Command } from "../controls/command";
import { type Action, actionNamed, keyName, labelOf } from "../input/actions";
import type { ViewState } from "../session/view-state";

export class EditButtons {
  readonly element = document.createElement("div");
  private readonly undo: Command;
  private readonly redo: Command;

  constructor(perform: (action: Action) => void) {
    this.element.className = "edits";
    const button = (name: string) => {
      const made = new Command(
        labelOf(actionNamed(name)),
        () => perform(actionNamed(name)),
        keyName(actionNamed(name)),
      );
      this.element.append(made.element);
      return made.enable(false);
    };
    this.undo = button("undo");
    this.redo = button("redo");
  }

  /** The focus of a button that has nothing to do any more goes to the other one, or the keyboard would lose its place. */
  update({ canUndo, canRedo }: Pick<ViewState, "canUndo" | "canRedo">): void {
    const focused = document.activeElement;
    this.undo.enable(canUndo);
    this.redo.enable(canRedo);
    if (focused === this.undo.element && !canUndo) this.redo.element.focus();
    if (focused === this.redo.element && !canRedo) this.undo.element.focus();
  }
}
