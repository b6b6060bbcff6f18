import { describe, expect, it, test } from "vitest";
import { ACTIONS } from "./actions";
import { actionOf, type KeyPress, keepsKey } from "./keys";
import { movesOf } from "./moves";

function press(code: string, key: string, more: Partial<KeyPress> = {}): string | undefined {
  const plain = { repeat: false, ctrlKey: false, metaKey: false, altKey: false, shiftKey: false };
  return actionOf({ code, key, isComposing: false, ...plain, ...more })?.name;
}

describe("a key press", () => {
  // The report's section 2.
  test.each([
    ["KeyC", "c", "camera"],
    ["Digit1", "1", "light_1"],
    ["Digit2", "2", "light_2"],
    ["ArrowLeft", "ArrowLeft", "left"],
    ["ArrowRight", "ArrowRight", "right"],
    ["ArrowUp", "ArrowUp", "up"],
    ["ArrowDown", "ArrowDown", "down"],
    ["KeyI", "i", "in"],
    ["KeyO", "o", "out"],
    ["KeyF", "f", "reset_camera"],
    ["KeyP", "p", "fall"],
    ["KeyR", "r", "reset_stone"],
    ["KeyM", "m", "mirror"],
    ["KeyL", "l", "sky"],
    ["KeyW", "w", "walls"],
    ["KeyS", "s", "download"],
  ])("%s means what the report says", (code, key, name) => {
    expect(press(code, key)).toBe(name);
  });

  it("with Ctrl or Cmd undoes and redoes, by the printed letter alone", () => {
    const ctrl = { ctrlKey: true };
    expect(press("KeyZ", "z", ctrl)).toBe("undo");
    expect(press("KeyY", "z", { metaKey: true })).toBe("undo");
    expect(press("KeyZ", "Z", { ...ctrl, shiftKey: true })).toBe("redo");
    expect(press("KeyY", "y", ctrl)).toBe("redo");
    expect(press("KeyS", "s", ctrl)).toBeUndefined();
    expect(press("KeyZ", "z", { ...ctrl, altKey: true })).toBeUndefined();
    expect(press("KeyZ", "z")).toBeUndefined();
  });

  it("on AZERTY counts by the printed letter, and by position where that prints nothing of ours", () => {
    expect(press("Semicolon", "m")).toBe("mirror");
    expect(press("KeyM", ",")).toBe("mirror");
    expect(press("Digit1", "&")).toBe("light_1");
    expect(press("KeyZ", "w")).toBe("walls");
  });

  it("whose letter and position mean two things does what is printed on it, once", () => {
    expect(press("KeyI", "c")).toBe("camera"); // Dvorak
  });

  it("in another script counts by position", () => {
    expect(press("KeyC", "\u0441")).toBe("camera"); // Cyrillic es
  });

  it("that moves, with shift turns", () => {
    expect(press("ArrowLeft", "ArrowLeft", { shiftKey: true })).toBe("turn_left");
    expect(press("ArrowUp", "ArrowUp", { shiftKey: true, repeat: true })).toBe("turn_up");
    expect(press("KeyI", "I", { shiftKey: true })).toBe("in");
  });

  it("counts with shift or caps lock, and on the keypad", () => {
    expect(press("KeyM", "M")).toBe("mirror");
    expect(press("Numpad2", "2")).toBe("light_2");
  });

  it.each(["ctrlKey", "metaKey", "altKey", "isComposing"] as const)("with %s is the browser's", (modifier) => {
    expect(press("KeyS", "s", { [modifier]: true })).toBeUndefined();
  });

  it("that is held down moves on, but toggles once", () => {
    expect(press("ArrowUp", "ArrowUp", { repeat: true })).toBe("up");
    expect(press("KeyP", "p", { repeat: true })).toBeUndefined();
  });

  it("of another key means nothing", () => {
    expect(press("KeyQ", "q")).toBeUndefined();
    expect(press("Tab", "Tab")).toBeUndefined();
  });
});

test("no two actions share a key", () => {
  expect(new Set(ACTIONS.map(({ key }) => key)).size).toBe(ACTIONS.length);
  expect(new Set(ACTIONS.map(({ code }) => code)).size).toBe(ACTIONS.length);
});

test("moves are sent for the chosen target, half a radius a press", () => {
  const sent = ACTIONS.flatMap(({ effect }) => (effect.kind === "move" ? movesOf(effect.move, "light_2", "") : []));
  expect(sent).toContainEqual({ type: "translate", target: "light_2", right: -0.5, up: 0 });
  expect(sent).toContainEqual({ type: "dolly", target: "light_2", forward: 0.5 });
});

describe("a key belongs to", () => {
  const element = (tagName: string, type = "", open = false) => ({
    tagName,
    type,
    isContentEditable: false,
    closest: () => null,
    matches: (selector: string) => selector === ":open" && open,
  });

  it("whom types, and not to buttons and check boxes", () => {
    for (const key of ["p", "ArrowUp"]) {
      expect(keepsKey(element("INPUT", "text"), key)).toBe(true);
      expect(keepsKey(element("INPUT", "number"), key)).toBe(true);
      expect(keepsKey(element("TEXTAREA"), key)).toBe(true);
      expect(keepsKey({ ...element("DIV"), isContentEditable: true }, key)).toBe(true);
      expect(keepsKey(element("INPUT", "checkbox"), key)).toBe(false);
      expect(keepsKey(element("BUTTON", "button"), key)).toBe(false);
      expect(keepsKey(element("CANVAS"), key)).toBe(false);
    }
  });

  it.each(["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"])("the list that has the focus, if it is %s", (key) => {
    expect(keepsKey(element("SELECT"), key)).toBe(true);
    expect(keepsKey({ ...element("BUTTON"), closest: () => ({}) as Element }, key)).toBe(true);
  });

  it("the slider that has the focus, if it is an arrow key, and the page if it is a letter", () => {
    expect(keepsKey(element("INPUT", "range"), "ArrowLeft")).toBe(true);
    expect(keepsKey(element("INPUT", "range"), "p")).toBe(false);
  });

  it("the page, if it is a letter on a list that is folded", () => {
    expect(keepsKey(element("SELECT"), "p")).toBe(false);
    expect(keepsKey(element("SELECT", "", true), "p")).toBe(true);
    expect(keepsKey({ ...element("BUTTON"), closest: () => ({}) as Element }, "p")).toBe(false);
  });

  it("the list where the browser cannot tell whether it is folded", () => {
    const unknown = () => {
      throw new SyntaxError("unknown pseudo-class");
    };
    expect(keepsKey({ ...element("SELECT"), matches: unknown }, "p")).toBe(true);
  });
});
