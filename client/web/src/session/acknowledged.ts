/** When the engine is done with what this viewer has sent: a `reach` that is asked after it is answered after it. */

import type { Reach, Reached } from "@culet/protocol/messages";

/** Of these numbers on: those below are of `Delays`, whose answers come the same way. */
const FIRST = 2 ** 31;
/** ms, after which no answer will come: a server gives up what its engine has not answered within 10 s, and says so. */
const PATIENCE_MS = 11_000;

export class Acknowledged {
  private readonly ask: (question: Reach) => void;
  private number = FIRST;
  private readonly waiting = new Map<number, () => void>();

  constructor(ask: (question: Reach) => void) {
    this.ask = ask;
  }

  /** Whatever was sent before this is done, was refused, or was given up. */
  all(): Promise<void> {
    this.number += 1;
    const { number } = this;
    return new Promise((resolve) => {
      const timer = setTimeout(() => this.waiting.get(number)?.(), PATIENCE_MS);
      this.waiting.set(number, () => {
        clearTimeout(timer);
        this.waiting.delete(number);
        resolve();
      });
      this.ask({ type: "reach", number });
    });
  }

  heard({ number }: Reached): void {
    this.waiting.get(number)?.();
  }
}
