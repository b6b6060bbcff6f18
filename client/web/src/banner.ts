/** One line over the picture while it is not live, and the card that stands in the way when there is nothing to show. */

import { CloseCode } from "@culet/protocol/messages";
import type { Connection } from "./stream";

/** What to say about the connection, or null while all is well. */
export function bannerText(connection: Connection, engine: "down" | "up"): string | null {
  switch (connection.status) {
    case "connecting":
      return "Connecting\u2026";
    case "waiting":
      return `Connection lost. ${tryingAgainText(connection.delay)}`;
    case "closed":
      return "Not connected.";
    case "open":
      return engine === "down" ? "The render process stopped and is being restarted. The scene is kept." : null;
  }
}

/** What stands where the picture will be. */
export const WAITING = "Waiting for the first picture\u2026";
export const WAITING_LONG = `${WAITING}\nA server that is new to its processor first compiles its kernels for it, once.`;

/** What to say of a session that the server had lost. */
export const REGAINED = "The server had lost this session. It was made again as this page last saw it.";
export const NOT_REGAINED = "The server has lost this session, and it cannot be made again.";

/** When the next try is, after a pause of so many milliseconds. */
export function tryingAgainText(delay: number): string {
  return `Trying again in ${Math.max(1, Math.round(delay / 1000))} s\u2026`;
}

/** Why a stream is over for good, for the card. */
export function obstacleText(code: number, reason: string): string {
  switch (code) {
    case CloseCode.UNKNOWN_SESSION:
      return "There is no such session (any more). It may have been closed, or expired.";
    case CloseCode.PROTOCOL_ERROR:
      return "This page and the server speak different versions. Reload the page.";
    case CloseCode.FORBIDDEN_ORIGIN:
      return "The server does not let this page watch: it was served from another origin.";
    default:
      return reason ? `The stream ended: ${reason}` : `The stream ended (code ${code}).`;
  }
}

export class Banner {
  private readonly element: HTMLElement;
  private readonly words: HTMLElement;

  /** `words`: the part of it that holds the text, if it has others. */
  constructor(element: HTMLElement, words = element) {
    this.element = element;
    this.words = words;
  }

  show(text: string | null): void {
    this.element.hidden = text === null;
    if (text !== null && this.words.textContent !== text) this.words.textContent = text;
  }
}

export class Obstacle {
  private readonly card: HTMLElement;
  private readonly text: HTMLElement;
  private readonly button: HTMLButtonElement;

  constructor(card: HTMLElement, text: HTMLElement, button: HTMLButtonElement) {
    this.card = card;
    this.text = text;
    this.button = button;
  }

  show(text: string, label: string, act: () => void): void {
    const wasHidden = this.card.hidden;
    this.text.textContent = text;
    this.button.textContent = label;
    this.button.onclick = act;
    this.card.hidden = false;
    if (wasHidden) this.button.focus();
  }

  hide(): void {
    this.card.hidden = true;
  }
}
