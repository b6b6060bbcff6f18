/** One line over the picture while it is not live, and the card that stands in the way when there is nothing to show. */

import { CloseCode } from "@culet/protocol/messages";
import type { Connection } from "../session/stream";
import { words } from "../words/words";

/** What to say about the connection, or null while all is well. */
export function bannerText(connection: Connection, engine: "down" | "up"): string | null {
  switch (connection.status) {
    case "connecting":
      return words.connection.connecting;
    case "waiting":
      return words.connection.lost(tryingAgainText(connection.delay));
    case "closed":
      return words.connection.closed;
    case "open":
      return engine === "down" ? words.connection.engineDown : null;
  }
}

/** When the next try is, after a pause of so many milliseconds. */
export function tryingAgainText(delay: number): string {
  return words.connection.tryingAgain(Math.max(1, Math.round(delay / 1000)));
}

/** Why a stream is over for good, for the card. */
export function obstacleText(code: number, reason: string): string {
  switch (code) {
    case CloseCode.UNKNOWN_SESSION:
      return words.connection.unknownSession;
    case CloseCode.PROTOCOL_ERROR:
      return words.connection.otherVersion;
    case CloseCode.FORBIDDEN_ORIGIN:
      return words.connection.foreignOrigin;
    default:
      return reason ? words.connection.ended(reason) : words.connection.endedByCode(code);
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
