/** What the server finds in the scene of a session, such as stones inside each other: told once the scene stays as it is. */

/** ms without a change before it is asked for: a slider that is dragged changes the scene many times a second. */
export const PAUSE_MS = 1000;

export class Findings {
  private readonly find: () => Promise<readonly string[]>;
  private readonly tell: (text: string) => void;
  private found: readonly string[] = [];
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `find` asks the server; `tell` has what was not found the last time. */
  constructor(find: () => Promise<readonly string[]>, tell: (text: string) => void) {
    this.find = find;
    this.tell = tell;
  }

  /** The scene is another now. */
  changed(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.ask(), PAUSE_MS);
  }

  private async ask(): Promise<void> {
    let found: readonly string[];
    try {
      found = await this.find();
    } catch {
      return; // the stream tells of a server that cannot be asked
    }
    const news = found.filter((sentence) => !this.found.includes(sentence));
    this.found = found;
    if (news.length > 0) this.tell(news.join("\n"));
  }
}
