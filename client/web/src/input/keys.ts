/** Which action a key press means. */

import { ACTIONS, type Action, actionNamed } from "./actions";

export type KeyPress = Pick<
  KeyboardEvent,
  "code" | "key" | "repeat" | "ctrlKey" | "metaKey" | "altKey" | "shiftKey" | "isComposing"
>;

const BY_KEY = new Map(ACTIONS.map((action) => [action.key, action]));
const BY_CODE = new Map(ACTIONS.map((action) => [action.code, action]));

/**
 * The action of a key press, or null. The printed letter counts first, since it is what the user reads; a key that prints
 * nothing of ours counts by its position, so that other layouts and scripts work as well.
 */
export function actionOf(press: KeyPress): Action | null {
  if (press.altKey || press.isComposing) return null;
  if (press.ctrlKey || press.metaKey) return editOf(press);
  const key = press.key.toLowerCase();
  const action = (press.shiftKey && BY_KEY.get(`shift+${key}`)) || BY_KEY.get(key) || BY_CODE.get(press.code);
  return action && (action.repeats || !press.repeat) ? action : null;
}

/** Ctrl Z and its kin, by the printed letter alone: on some layouts Z and Y have changed places. */
function editOf({ key, shiftKey }: KeyPress): Action | null {
  switch (key.toLowerCase()) {
    case "z":
      return actionNamed(shiftKey ? "redo" : "undo");
    case "y":
      return shiftKey ? null : actionNamed("redo");
    default:
      return null;
  }
}

const NOT_TEXT = new Set(["button", "checkbox", "color", "file", "image", "radio", "reset", "submit"]);

/** Keys that walk through a list or along a slider, whatever they mean elsewhere. */
const WALKING = new Set(["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"]);

type Focused = Pick<HTMLElement, "tagName" | "isContentEditable"> & {
  type?: string;
  closest: (selector: string) => unknown;
  matches: (selector: string) => boolean;
};

/** Whether a key press is that of the element that has the focus, a text field, a slider or a list of choices, and so not ours. */
export function keepsKey(element: Focused, key: string): boolean {
  if (element.isContentEditable || element.tagName === "TEXTAREA") return true;
  if (element.tagName === "INPUT" && element.type === "range") return WALKING.has(key);
  if (element.tagName === "INPUT") return !NOT_TEXT.has(element.type ?? "text");
  if (element.tagName === "SELECT") return WALKING.has(key) || isOpen(element);
  return WALKING.has(key) && element.closest(LIST) !== null;
}

/** What holds entries that the arrow keys walk through. */
export const LIST = "[data-arrow-keys]";

/** Whether a list's choices are unfolded: every letter looks for one of them then. A browser that cannot tell has them open. */
function isOpen(list: Focused): boolean {
  try {
    return list.matches(":open");
  } catch {
    return true;
  }
}

/** Listen while the page lives. In the capture phase, so that nothing can keep key presses to itself. */
export function listenToKeys(target: Window, perform: (action: Action) => void): void {
  target.addEventListener(
    "keydown",
    (event) => {
      if (event.target instanceof HTMLElement && keepsKey(event.target, event.key)) return;
      const action = actionOf(event);
      if (!action) return;
      event.preventDefault();
      perform(action);
    },
    { capture: true },
  );
}
