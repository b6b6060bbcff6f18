/** The panel's list of stones, for the keyboard as well, and what can be done to the one that is chosen. */

import { Choice } from "../controls/choice";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { type Action, actionNamed, keyName, labelOf } from "../input/actions";
import type { ViewState } from "../session/view-state";
import { idsOf } from "../stones/stones";
import { words } from "../words/words";

/** What `StoneCommands` does. */
export interface StoneActions {
  choose: (id: string | null) => void;
  add: () => void;
  look: () => void;
  reset: () => void;
  hold: () => void;
  scatter: () => void;
}

/** No id has brackets, and none is empty. */
const NONE = { label: words.stones.none, value: "" };

export class StonePanel {
  private readonly list = new Choice<string>(words.stones.chosen, [NONE], NONE.value);
  private readonly ofOne: readonly Command[];
  private readonly remove: Command;
  private readonly putBack: Command;
  private ids: readonly string[] = [];

  constructor(section: Section, perform: (action: Action) => void, actions: StoneActions) {
    section.add(this.list).onInput((id) => actions.choose(id || null));
    const button = (label: string, act: () => void, key = "") => section.add(new Command(label, act, key));
    const acting = (name: string) => {
      const action = actionNamed(name);
      return button(labelOf(action), () => perform(action), keyName(action));
    };
    this.ofOne = [
      button(words.stones.look, () => actions.look()),
      button(words.stones.putBack, () => actions.reset()),
      button(words.stones.hold, () => actions.hold()),
    ];
    button(words.stones.add, () => actions.add());
    this.remove = acting("remove_stone");
    this.putBack = acting("put_back_stone");
    button(words.stones.scatter, () => actions.scatter());
  }

  /** `removed`: how many stones this viewer has removed, and may put back. */
  update({ scene, stone }: ViewState, removed: number): void {
    const ids = idsOf(scene);
    if (String(ids) !== String(this.ids)) {
      this.ids = ids;
      this.list.offer([NONE, ...ids.map((id) => ({ label: id, value: id }))]);
    }
    this.list.value = stone ?? NONE.value;
    for (const button of this.ofOne) button.show(stone !== null);
    this.remove.label(labelOf(actionNamed("remove_stone"), scene));
    this.putBack.enable(removed > 0);
  }
}
