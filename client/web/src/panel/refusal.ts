/** Why the server refused what was done with a control, below that control. */

export class Refusal {
  readonly element = document.createElement("p");
  /** What it was refused for. */
  private of = "";

  constructor() {
    this.element.className = "refusal";
    this.element.setAttribute("role", "alert");
    this.hide();
  }

  /** It stays until the control is used again, or what it is about is another. */
  tell(why: string, of: string): void {
    this.of = of;
    this.element.textContent = why;
    this.element.hidden = false;
  }

  /** What is there now. */
  about(now: string): void {
    if (now !== this.of) this.hide();
  }

  hide(): void {
    this.element.hidden = true;
  }
}
