/** What is said over the picture, or stands in its way: the connection, a wait, stones out of sight, the end. */

import { element } from "../page";
import type { Connection } from "../session/stream";
import { words } from "../words/words";
import { Banner, bannerText, Obstacle, tryingAgainText } from "./banner";

/** ms after which a wait for the first picture is explained. */
const LONG_MS = 1500;

export class Signs {
  private readonly banner = new Banner(element("banner", HTMLElement));
  private readonly unseen = new Banner(element("unseen", HTMLElement), element("unseen-text", HTMLElement));
  private readonly look = element("unseen-button", HTMLButtonElement);
  private readonly waiting = new Banner(element("waiting", HTMLElement));
  private readonly obstacle = new Obstacle(
    element("obstacle", HTMLElement),
    element("obstacle-text", HTMLElement),
    element("obstacle-button", HTMLButtonElement),
  );
  private readonly startAnew: () => void;
  private readonly obstructed: (text: string, passes: boolean) => void;
  private wrong: string | null = null;
  private elsewhere: string | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /**
   * `look` has stones that are out of sight looked at, `startAnew` leaves for a new session; `obstructed` is told what is
   * in the way of a picture, and whether that may pass by itself.
   */
  constructor(look: () => void, startAnew: () => void, obstructed: (text: string, passes: boolean) => void) {
    this.startAnew = startAnew;
    this.obstructed = obstructed;
    this.look.onclick = look;
    this.waiting.show(words.connection.connecting);
  }

  /** The connection is another, or what renders is. */
  connected(connection: Connection, engine: "down" | "up"): void {
    this.wrong = bannerText(connection, engine);
    this.display();
  }

  /** Where the stones are, if the picture shows none of them. */
  stones(elsewhere: string | null): void {
    this.elsewhere = elsewhere;
    this.display();
  }

  /** What the button says that has them looked at. */
  lookLabel(text: string): void {
    if (this.look.textContent !== text) this.look.textContent = text;
  }

  /** The first picture is on its way. */
  await(): void {
    this.waiting.show(words.connection.waiting);
    this.timer = setTimeout(() => this.waiting.show(words.connection.waitingLong), LONG_MS);
  }

  /** There is a picture. */
  arrived(): void {
    clearTimeout(this.timer);
    this.waiting.show(null);
  }

  /** There will be no picture of this session. */
  end(text: string): void {
    this.banner.show(null);
    this.obstacle.show(text, words.connection.startAnew, this.startAnew);
    this.obstructed(text, false);
  }

  /** Something failed: it can be tried again if the user wants to. */
  retry(text: string, again: () => void): void {
    this.banner.show(null);
    this.obstacle.show(text, words.connection.tryAgain, again);
    this.obstructed(text, false);
  }

  /** Something failed, and is tried again after a pause, ms, or at once. */
  retryAfter(text: string, delay: number, again: () => void): void {
    this.banner.show(null);
    this.obstacle.show(`${text}\n${tryingAgainText(delay)}`, words.connection.tryNow, again);
    this.obstructed(text, true);
  }

  /** Nothing is in the way any more. */
  clear(): void {
    this.obstacle.hide();
  }

  /** What is wrong, or else why there is nothing to see. */
  private display(): void {
    this.banner.show(this.wrong);
    this.unseen.show(this.wrong === null ? this.elsewhere : null);
  }
}
