/** The words beside the panel, or under it, that say what a control means: of the one that has the focus, or is under the pointer. */

export class Hints {
  readonly element = document.createElement("p");
  private pointed = "";
  private focused = "";

  /** For the controls in `region`. Hidden from screen readers, which read each control's own description. */
  constructor(region: HTMLElement) {
    this.element.className = "hint";
    this.element.setAttribute("aria-hidden", "true");
    region.addEventListener("focusin", ({ target }) => {
      this.place(target);
      this.show({ focused: hintOf(target) });
    });
    region.addEventListener("focusout", () => this.show({ focused: "" }));
    region.addEventListener("pointerover", ({ target }) => {
      this.place(target);
      this.show({ pointed: hintOf(target) });
    });
    region.addEventListener("pointerleave", () => this.show({ pointed: "" }));
    // Another entry of a list has another meaning.
    region.addEventListener("input", ({ target }) => setTimeout(() => this.show({ focused: hintOf(target) })));
    this.show({});
  }

  /** At the height of the control. */
  private place(target: EventTarget | null): void {
    const control = controlOf(target);
    if (control) this.element.style.setProperty("--at", `${control.getBoundingClientRect().top}px`);
  }

  private show({ pointed = this.pointed, focused = this.focused }: { pointed?: string; focused?: string }): void {
    this.pointed = pointed;
    this.focused = focused;
    const text = pointed || focused;
    this.element.hidden = text === "";
    if (text !== "") this.element.textContent = text;
  }
}

function controlOf(target: EventTarget | null): HTMLElement | null {
  return target instanceof Element ? target.closest<HTMLElement>("[data-hint]") : null;
}

function hintOf(target: EventTarget | null): string {
  return controlOf(target)?.dataset.hint ?? "";
}
