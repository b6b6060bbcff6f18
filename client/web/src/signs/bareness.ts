/** Nothing but the picture: everything else hidden, until a key or a tap brings it back. */

export class Bareness {
  private readonly main: HTMLElement;
  private readonly tell: () => () => void;
  private forget = () => {};

  /** `tell` says how to come back, and returns what takes the words away. */
  constructor(main: HTMLElement, tell: () => () => void) {
    this.main = main;
    this.tell = tell;
  }

  /** For good, as the address asks: nothing says how to come back. */
  stay(): void {
    this.main.classList.add("bare", "embedded");
  }

  /** Until a key or a tap brings everything back. */
  get on(): boolean {
    return this.main.classList.contains("bare") && !this.main.classList.contains("embedded");
  }

  toggle(): void {
    this.forget();
    if (this.main.classList.contains("embedded")) return;
    this.main.classList.toggle("bare");
    this.forget = this.on ? this.tell() : () => {};
  }
}
