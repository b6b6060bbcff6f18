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
  private readonly status = document.createElement("p");

  /** `dialog` is closed; `body` is filled when it is opened. */
  constructor(dialog: HTMLDialogElement, body: HTMLElement, close: HTMLButtonElement) {
    this.dialog = dialog;
    this.body = body;
    this.status.setAttribute("role", "status");
    body.after(this.status); // within the card: nothing else is seen, or read out, while it is open
    close.onclick = () => dialog.close();
    dialog.onclick = (event) => {
      if (event.target === dialog) dialog.close(); // beside the card
    };
  }

  async show({ session, watch }: Shared): Promise<void> {
    this.status.textContent = "";
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
    copy.onclick = () => copyLink(field, this.status);
    row.className = "link";
    row.append(label, copy);
    return [row];
  }
}

/** Put the link in a field on the clipboard, and tell how that went; what cannot be put there is selected instead. */
export async function copyLink(
  field: Pick<HTMLInputElement, "value" | "focus" | "select">,
  status: Pick<HTMLElement, "textContent">,
): Promise<void> {
  status.textContent = "";
  try {
    await copyText(async () => field.value);
    status.textContent = words.share.copied;
  } catch {
    field.focus();
    field.select();
    status.textContent = words.share.selected;
  }
}

function paragraph(text: string): HTMLElement {
  const made = document.createElement("span");
  made.textContent = text;
  return made;
}
