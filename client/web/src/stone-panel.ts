/** The panel's list of stones, for the keyboard as well, and what can be done to the one that is chosen. */

import type { Controller, GUI } from "lil-gui";
import { type Action, actionNamed, labelWithKey } from "./actions";
import { idsOf } from "./stones";
import type { ViewState } from "./view-state";

export interface StoneActions {
  perform: (action: Action) => void;
  choose: (id: string | null) => void;
  add: () => void;
  scatter: () => void;
}

const NONE = "none";

export class StonePanel {
  private readonly shown = { stone: "" };
  private readonly choose: StoneActions["choose"];
  private readonly putBack: Controller;
  private list: Controller;
  private ids: readonly string[] = [];

  constructor(folder: GUI, { perform, choose, add, scatter }: StoneActions) {
    this.choose = choose;
    this.list = folder.add(this.shown, "stone", { [NONE]: "" });
    this.listen();
    folder.add({ add }, "add").name("Add another like it");
    this.addAction(folder, actionNamed("remove_stone"), perform);
    this.putBack = this.addAction(folder, actionNamed("put_back_stone"), perform);
    folder.add({ scatter }, "scatter").name("Scatter all");
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
    this.putBack.enable(removed > 0);
  }

  private listen(): void {
    this.list.name("Chosen").onChange((id: string) => this.choose(id || null));
  }

  private addAction(folder: GUI, action: Action, perform: StoneActions["perform"]): Controller {
    return folder.add({ act: () => perform(action) }, "act").name(labelWithKey(action));
  }
}
