/** When the server is done with what this viewer has sent: a `reach` that is asked after it is answered after it. */

import type { Problem, Reach, Reached } from "@culet/protocol/messages";
import { words } from "../words/words";

/** Of these numbers on: those below are of `Delays`, whose answers come the same way. */
const FIRST = 2 ** 31;
/** ms, after which no answer will come: a server gives up what its engine has not answered within 10 s, and says so. */
const PATIENCE_MS = 11_000;
/** Codes of problems that pass by themselves: what was refused may be sent again. */
const PASSING: readonly string[] = ["at_the_limit", "engine_unavailable"];

/** How many messages were sent by which connection. */
export interface Sent {
  connection: number;
  count: number;
}

interface Waiting {
  /** The messages that it waits for, its own question the last. */
  connection: number;
  first: number;
  last: number;
  /** Why some of that was given up. */
  why: string | null;
  end: (why: string | null) => void;
}

export class Acknowledged {
  private readonly ask: (question: Reach) => void;
  private readonly sent: () => Sent;
  private number = FIRST;
  private readonly waiting = new Map<number, Waiting>();

  constructor(ask: (question: Reach) => void, sent: () => Sent) {
    this.ask = ask;
    this.sent = sent;
  }

  /**
   * Do what sends something; ends when the server is done with that, or has refused it: with null, or why some of it was
   * given up, or may be, and can be sent again. Without a connection nothing is sent, and nothing to be waited for.
   */
  after(work: () => void): Promise<string | null> {
    this.number += 1;
    const { number } = this;
    const first = this.sent().count + 1;
    work();
    if (this.sent().count < first) return Promise.resolve(null);
    return new Promise((resolve) => {
      const timer = setTimeout(() => this.waiting.get(number)?.end(words.connection.notAnswered), PATIENCE_MS);
      const { connection, count } = this.sent();
      const end = (why: string | null) => {
        clearTimeout(timer);
        this.waiting.delete(number);
        resolve(why);
      };
      this.waiting.set(number, { connection, first, last: count + 1, why: null, end });
      this.ask({ type: "reach", number });
    });
  }

  heard({ number }: Reached): void {
    const waiting = this.waiting.get(number);
    waiting?.end(waiting.why);
  }

  /** Whether whoever waits for that is told why it was refused, and so nobody else need be. */
  refused({ number, code, message }: Problem): boolean {
    const { connection } = this.sent();
    for (const waiting of this.waiting.values()) {
      if (waiting.connection !== connection || !number || number < waiting.first || number > waiting.last) continue;
      const passes = PASSING.includes(code);
      if (passes) waiting.why ??= message;
      if (number === waiting.last) waiting.end(waiting.why);
      return passes;
    }
    return false;
  }
}
