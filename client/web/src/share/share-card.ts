/** The card with a session's two links, and a QR code of the one that only watches. */

import { copyText } from "../files/clipboard";
import { sessionAddress, watchAddress } from "../session/session-url";
import { words } from "../words/words";
import { qrCode } from "./qr-code";

/** A session's ids. */
export interface Shared {
  session: string;
  watch: string;
}

const OWN_MACHINE = /^(localhost|127\.[\d.]+|\[::1\])$/;

export class ShareCard {
  private readonly dialog: HTMLDialogElement;
  private readonly body: HTMLElement;
  private readonly note: (text: string) => void;

  /** `dialog` is closed; `body` is filled when it is opened. `note` tells the user something that passes. */
  constructor(dialog: HTMLDialogElement, body: HTMLElement, close: HTMLButtonElement, note: (text: string) => void) {
    this.dialog = dialog;
    this.body = body;
    this.note = note;
    close.onclick = () => dialog.close();
    dialog.onclick = (event) => {
      if (event.target === dialog) dialog.close(); // beside the card
    };
  }

  async show({ session, watch }: Shared): Promise<void> {
    const watching = new URL(watchAddress(watch), location.href).href;
    this.body.replaceChildren(
      ...this.link(words.share.steer, new URL(sessionAddress(session), location.href).href),
      ...this.link(words.share.watch, watching),
    );
    this.dialog.showModal();
    const code = await qrCode(watching);
    code.setAttribute("aria-label", words.share.code);
    this.body.append(code);
    if (OWN_MACHINE.test(location.hostname)) this.body.append(paragraph(words.share.ownMachine));
  }

  private link(meaning: string, address: string): HTMLElement[] {
    const label = document.createElement("label");
    const field = document.createElement("input");
    const copy = document.createElement("button");
    const row = document.createElement("div");
    field.readOnly = true;
    field.value = address;
    field.onfocus = () => field.select();
    label.append(paragraph(meaning), field);
    copy.type = "button";
    copy.textContent = words.share.copy;
    copy.onclick = async () => {
      await copyText(async () => address);
      this.note(words.share.copied);
    };
    row.className = "link";
    row.append(label, copy);
    return [row];
  }
}

function paragraph(text: string): HTMLElement {
  const made = document.createElement("span");
  made.textContent = text;
  return made;
}
