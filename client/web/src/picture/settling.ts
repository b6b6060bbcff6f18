/**
 * After the window has changed its shape, as a phone that is turned, the picture of the shape before fills it, its sides cut
 * off, until one of the new shape comes: no black bars come and go.
 */

/** ms after which the picture is shown whole nevertheless: another viewer's window may decide on its shape. */
export const PATIENCE_MS = 8000;

export class Settling {
  private readonly ended: () => void;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `ended` is called where the patience ends. */
  constructor(ended: () => void) {
    this.ended = ended;
  }

  get on(): boolean {
    return this.timer !== undefined;
  }

  /** The window has another size. `fitted`: the picture had the window's shape so far; one that had not stays whole. */
  resized(fitted: boolean): void {
    if (!fitted && !this.on) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.ended();
    }, PATIENCE_MS);
  }

  /** Another picture is shown. `fits`: it has the window's shape. */
  shown(fits: boolean): void {
    if (!fits) return;
    clearTimeout(this.timer);
    this.timer = undefined;
  }
}
