/** The card that lists what keys, mouse and fingers do. */

import { worded } from "../words/wording";
import { words } from "../words/words";
import { ACTIONS, keyName } from "./actions";

export class KeyCard {
  private readonly dialog: HTMLDialogElement;

  /** `dialog` is closed; its table is filled. */
  constructor(dialog: HTMLDialogElement, table: HTMLTableElement, close: HTMLButtonElement) {
    this.dialog = dialog;
    const keys = ACTIONS.map((action) => [keyName(action), worded(action.label, null)] as const);
    for (const [key, meaning] of [...keys, ...words.gestures]) {
      const row = table.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      const name = document.createElement("kbd");
      name.textContent = key;
      head.append(name);
      row.append(head);
      row.insertCell().textContent = meaning;
    }
    close.onclick = () => dialog.close();
    dialog.onclick = (event) => {
      if (event.target === dialog) dialog.close(); // beside the card
    };
  }

  /** Or hide it, if it is shown. */
  toggle(): void {
    if (this.dialog.open) this.dialog.close();
    else {
      this.dialog.showModal();
      this.dialog.scrollTop = 0; // the focus goes to the button at the end
    }
  }
}
