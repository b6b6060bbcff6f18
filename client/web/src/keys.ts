/** Which action a key press means. */

import { ACTIONS, type Action } from "./actions";

export type KeyPress = Pick<
  KeyboardEvent,
  "code" | "key" | "repeat" | "ctrlKey" | "metaKey" | "altKey" | "isComposing"
>;

const BY_KEY = new Map(ACTIONS.map((action) => [action.key, action]));
const BY_CODE = new Map(ACTIONS.map((action) => [action.code, action]));

/**
 * The action of a key press, or null. The printed letter counts first, since it is what the user reads; a key that prints
 * nothing of ours counts by its position, so that other layouts and scripts work as well.
 */
export function actionOf(press: KeyPress): Action | null {
  if (press.ctrlKey || press.metaKey || press.altKey || press.isComposing) return null;
  const action = BY_KEY.get(press.key.toLowerCase()) ?? BY_CODE.get(press.code);
  return action && (action.repeats || !press.repeat) ? action : null;
}

const NOT_TEXT = new Set(["button", "checkbox", "color", "file", "image", "radio", "reset", "submit"]);

/** Whether keys go into a text field or a list of choices, and so are not ours. */
export function isTyping(element: Pick<HTMLElement, "tagName" | "isContentEditable"> & { type?: string }): boolean {
  if (element.isContentEditable || element.tagName === "TEXTAREA" || element.tagName === "SELECT") return true;
  return element.tagName === "INPUT" && !NOT_TEXT.has(element.type ?? "text");
}

/** Listen while the page lives. In the capture phase, because the panel keeps key presses to itself. */
export function listenToKeys(target: Window, perform: (action: Action) => void): void {
  target.addEventListener(
    "keydown",
    (event) => {
      if (event.target instanceof HTMLElement && isTyping(event.target)) return;
      const action = actionOf(event);
      if (!action) return;
      event.preventDefault();
      perform(action);
    },
    { capture: true },
  );
}
