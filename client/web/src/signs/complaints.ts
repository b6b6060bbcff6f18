/** What went wrong on this page: told to the user, and kept for whoever looks for the cause. */

import type { Toasts } from "./toasts";

/** So many are kept. */
const KEPT = 100;

export class Complaints {
  readonly kept: string[] = [];
  /** Whether a problem is shown in another place than the corner. */
  shownElsewhere: (text: string, about: string | undefined) => boolean = () => false;
  private readonly toasts: Toasts;

  constructor(toasts: Toasts) {
    this.toasts = toasts;
  }

  /** Of several `about` the same the newest is shown. */
  tell(text: string, about?: string): void {
    if (this.kept.push(text) > KEPT) this.kept.shift();
    if (!this.shownElsewhere(text, about)) this.toasts.problem(text, about);
  }

  /** Run what may be refused, and tell the user why. */
  attempt(work: () => Promise<void>): void {
    work().catch((error: unknown) => this.tell(reasonOf(error)));
  }
}

/** An error's words for the user. */
export function reasonOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
