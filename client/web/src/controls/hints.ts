/** The words beside the panel, or under it, that say what a control means: of the one that is used, or is under the pointer. */

export class Hints {
  readonly element = document.createElement("p");
  private pointed: HTMLElement | null = null;
  private used: HTMLElement | null = null;

  /** For the controls in `region`. Hidden from screen readers, which read each control's own description. */
  constructor(region: HTMLElement) {
    this.element.className = "hint";
    this.element.setAttribute("aria-hidden", "true");
    region.addEventListener("focusin", ({ target }) => this.use(controlOf(target)));
    region.addEventListener("focusout", () => this.use(null));
    // Not every browser has what is clicked take the focus; then a press elsewhere ends its use.
    region.addEventListener("input", ({ target }) => this.use(controlOf(target)));
    document.addEventListener("pointerdown", ({ target }) => {
      if (!(target instanceof Node && region.contains(target))) this.use(null);
    });
    region.addEventListener("pointerover", ({ target }) => this.point(controlOf(target)));
    region.addEventListener("pointerleave", () => this.point(null));
    // Another entry of a list has another meaning, whoever chose it.
    new MutationObserver(() => this.show()).observe(region, { subtree: true, attributeFilter: ["data-hint"] });
    this.show();
  }

  private use(control: HTMLElement | null): void {
    this.used = control;
    this.place(control);
    this.show();
  }

  private point(control: HTMLElement | null): void {
    this.pointed = control;
    this.place(control);
    this.show();
  }

  /** At the height of the control. */
  private place(control: HTMLElement | null): void {
    if (control) this.element.style.setProperty("--at", `${control.getBoundingClientRect().top}px`);
  }

  private show(): void {
    const text = this.pointed?.dataset.hint || this.used?.dataset.hint || "";
    this.element.hidden = text === "";
    if (text !== "") this.element.textContent = text;
  }
}

function controlOf(target: EventTarget | null): HTMLElement | null {
  return target instanceof Element ? target.closest<HTMLElement>("[data-hint]") : null;
}
