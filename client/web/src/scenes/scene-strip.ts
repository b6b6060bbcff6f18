/** The presets as small pictures over the picture: what the page opens on. */

import type { Preset } from "../session/catalogue";

/** CSS pixels: in a lower window the strip is folded at first, for the picture's sake. */
const LOW = 480;

/** The entry that an arrow key or Home, End leads to from another; null if the key leads nowhere. */
export function entryAfter(key: string, from: number, count: number): number | null {
  switch (key) {
    case "ArrowLeft":
    case "ArrowUp":
      return Math.max(from - 1, 0);
    case "ArrowRight":
    case "ArrowDown":
      return Math.min(from + 1, count - 1);
    case "Home":
      return 0;
    case "End":
      return count - 1;
    default:
      return null;
  }
}

/** The presets with those of a group side by side, groups and presets in the order given. */
export function byGroup(presets: readonly Preset[]): Map<string, Preset[]> {
  const groups = new Map<string, Preset[]>();
  for (const preset of presets) groups.set(preset.group, [...(groups.get(preset.group) ?? []), preset]);
  return groups;
}

export class SceneStrip {
  private readonly list: HTMLElement;
  private readonly buttons: HTMLButtonElement[] = [];

  /** `list` scrolls, `toggle` hides and shows it. */
  constructor(list: HTMLElement, toggle: HTMLButtonElement) {
    this.list = list;
    const fold = (folded: boolean) => {
      list.hidden = folded;
      toggle.setAttribute("aria-expanded", String(!folded));
    };
    toggle.onclick = () => fold(!list.hidden);
    fold(window.innerHeight < LOW);
    list.addEventListener("keydown", (event) => this.walk(event));
    // A mouse has one wheel, and the list goes sideways.
    list.addEventListener("wheel", (event) => this.scroll(event), { passive: false });
  }

  show(presets: readonly Preset[], choose: (preset: Preset) => void): void {
    for (const [group, members] of byGroup(presets)) {
      const set = document.createElement("div");
      set.setAttribute("role", "group");
      set.setAttribute("aria-label", group);
      set.append(...members.map((preset) => this.entry(preset, choose)));
      this.list.append(set);
    }
    for (const button of this.buttons.slice(1)) button.tabIndex = -1; // one stop of the Tab key, as a list is
  }

  private entry(preset: Preset, choose: (preset: Preset) => void): HTMLButtonElement {
    const button = document.createElement("button");
    button.type = "button";
    button.title = preset.summary;
    const picture = document.createElement("img");
    picture.src = `api/${preset.thumbnail}`; // as it is beside the list of presets
    picture.alt = "";
    picture.width = 84;
    picture.height = 63;
    picture.loading = "lazy";
    const title = document.createElement("span");
    title.textContent = preset.title;
    button.append(picture, title);
    button.onclick = () => {
      this.focus(this.buttons.indexOf(button));
      choose(preset);
    };
    this.buttons.push(button);
    return button;
  }

  private walk(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const from = this.buttons.indexOf(document.activeElement as HTMLButtonElement);
    const to = from < 0 ? null : entryAfter(event.key, from, this.buttons.length);
    if (to === null) return;
    event.preventDefault();
    this.focus(to);
  }

  private focus(index: number): void {
    for (const [at, button] of this.buttons.entries()) button.tabIndex = at === index ? 0 : -1;
    this.buttons[index]?.focus();
    this.buttons[index]?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  private scroll(event: WheelEvent): void {
    if (event.deltaX !== 0 || event.ctrlKey) return;
    event.preventDefault();
    this.list.scrollLeft += event.deltaY;
  }
}
