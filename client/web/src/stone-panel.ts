/** The panel's list of stones, for the keyboard as well, and what can be done to the one that is chosen. */

import type { Controller, GUI } from "lil-gui";
import { type Action, actionNamed, labelWithKey } from "./actions";
import { idsOf } from "./stones";
import type { ViewState } from "./view-state";

/** What `StoneCommands` does. */
export interface StoneActions {
  choose: (id: string | null) => void;
  add: () => void;
  look: () => void;
  reset: () => void;
  hold: () => void;
  scatter: () => void;
}

/** No id has brackets. */
const NONE = "(none)";

export class StonePanel {
  private readonly shown = { stone: "" };
  private readonly actions: StoneActions;
  private readonly ofOne: readonly Controller[];
  private readonly remove: Controller;
  private readonly putBack: Controller;
  private list: Controller;
  private ids: readonly string[] = [];

  constructor(folder: GUI, perform: (action: Action) => void, actions: StoneActions) {
    this.actions = actions;
    this.list = folder.add(this.shown, "stone", { [NONE]: "" });
    this.listen();
    const button = (label: string, act: () => void) => folder.add({ act }, "act").name(label);
    const acting = (name: string) => button(labelWithKey(actionNamed(name)), () => perform(actionNamed(name)));
    this.ofOne = [
      button("Look at this stone", () => actions.look()),
      button("Put this stone back", () => actions.reset()),
      button("Hold this stone, or let go", () => actions.hold()),
    ];
    button("Add another like it", () => actions.add());
    this.remove = acting("remove_stone");
    this.putBack = acting("put_back_stone");
    button("Scatter all", () => actions.scatter());
  }

  /** `removed`: how many stones this viewer has removed, and may put back. */
  update({ scene, stone }: ViewState, removed: number): void {
    const ids = idsOf(scene);
    if (String(ids) !== String(this.ids)) {
      this.ids = ids;
      this.list = this.list.options({ [NONE]: "", ...Object.fromEntries(ids.map((id) => [id, id])) });
      this.listen();
    }
    this.shown.stone = stone ?? "";
    this.list.updateDisplay();
    for (const button of this.ofOne) button.show(stone !== null);
    this.remove.name(labelWithKey(actionNamed("remove_stone"), scene));
    this.putBack.enable(removed > 0);
  }

  private listen(): void {
    this.list.name("Chosen").onChange((id: string) => this.actions.choose(id || null));
  }
}
