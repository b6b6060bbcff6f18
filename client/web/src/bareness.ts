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

  get on(): boolean {
    return this.main.classList.contains("bare");
  }

  toggle(): void {
    this.forget();
    this.main.classList.toggle("bare");
    this.forget = this.on ? this.tell() : () => {};
  }
}
