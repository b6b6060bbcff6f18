/** Everything that a key or a button does: one catalogue for keyboard, panel and tests. */

import type { JsonObject } from "@culet/protocol/messages";
import type { SessionEvent, Target } from "./events";
import type { Move } from "./moves";
import type { Format } from "./rest";
import { type Wording, worded } from "./wording";

/** R a key press, as in the report. */
export const STEP = 0.5;

/** Radians a key press: 24 of them are half a turn. */
const TURN = Math.PI / 24;

export type Effect =
  | { kind: "select"; target: Target }
  | { kind: "send"; event: SessionEvent }
  | { kind: "move"; move: Move }
  | { kind: "download"; format: Format }
  | { kind: "copy"; what: "picture" | "link" }
  | { kind: "stones"; command: "lookAround" | "remove" | "putBack" }
  | { kind: "page"; command: "showKeys" | "hideAll" | "fillScreen" };

export interface Action {
  name: string;
  label: string | Wording;
  /** Letter or name printed on the key (`KeyboardEvent.key`, in lower case). */
  key: string;
  /** Where the key is on a QWERTY keyboard (`KeyboardEvent.code`). */
  code: string;
  /** Whether a key that is held down acts again. */
  repeats: boolean;
  effect: Effect;
}

function letter(name: string, key: string, label: Action["label"], effect: Effect, repeats = false): Action {
  return { name, label, key: key.toLowerCase(), code: `Key${key}`, repeats, effect };
}

function move(name: string, code: string, label: string, move: Move): Action {
  return { name, label, key: code.toLowerCase(), code, repeats: true, effect: { kind: "move", move } };
}

function select(target: Target, key: string, code: string, label: string): Action {
  return { name: target, label, key, code, repeats: false, effect: { kind: "select", target } };
}

function plain(name: string, key: string, label: Action["label"], type: Plain): Action {
  return letter(name, key, label, { kind: "send", event: { type } });
}

/** By a key with Ctrl, which `keys.ts` knows: no key has such a name or place. */
function edit(type: "undo" | "redo", key: string, label: string): Action {
  return { name: type, label, key, code: key, repeats: false, effect: { kind: "send", event: { type } } };
}

/** The events that say all by their type. */
type Plain =
  | "reset_camera"
  | "toggle_fall"
  | "reset_stone"
  | "toggle_mirror"
  | "toggle_environment"
  | "toggle_walls"
  | "undo"
  | "redo";

function dolly(forward: number): Effect {
  return { kind: "move", move: { forward } };
}

const LOOK = { one: "Look at the stone", several: "Look at the chosen stone, or all" };
const PUT_BACK = { one: "Put the stone back", several: "Put the stones back" };

export const ACTIONS: readonly Action[] = [
  select("camera", "c", "KeyC", "Move the camera"),
  select("light_1", "1", "Digit1", "Move the red light"),
  select("light_2", "2", "Digit2", "Move the blue light"),
  select("stone", "3", "Digit3", "Move the chosen stone"),
  move("left", "ArrowLeft", "Left", { right: -STEP }),
  move("right", "ArrowRight", "Right", { right: STEP }),
  move("up", "ArrowUp", "Up", { up: STEP }),
  move("down", "ArrowDown", "Down", { up: -STEP }),
  letter("in", "I", "In", dolly(STEP), true),
  letter("out", "O", "Out", dolly(-STEP), true),
  move("turn_left", "Shift+ArrowLeft", "Turn left", { yaw: -TURN }),
  move("turn_right", "Shift+ArrowRight", "Turn right", { yaw: TURN }),
  move("turn_up", "Shift+ArrowUp", "Turn up", { pitch: TURN }),
  move("turn_down", "Shift+ArrowDown", "Turn down", { pitch: -TURN }),
  plain("reset_camera", "F", "Reset the camera", "reset_camera"),
  letter("look", "V", LOOK, { kind: "stones", command: "lookAround" }),
  plain("fall", "P", "Fall or pause", "toggle_fall"),
  plain("reset_stone", "R", PUT_BACK, "reset_stone"),
  plain("mirror", "M", "Mirror or checker", "toggle_mirror"),
  plain("sky", "L", "Light sky, or the scene's own", "toggle_environment"),
  plain("walls", "W", "Walls", "toggle_walls"),
  {
    name: "remove_stone",
    label: { one: "Remove the stone", several: "Remove the chosen stone" },
    key: "delete",
    code: "Delete",
    repeats: false,
    effect: { kind: "stones", command: "remove" },
  },
  letter("put_back_stone", "U", "Take a removal back", { kind: "stones", command: "putBack" }),
  edit("undo", "ctrl+z", "Undo"),
  edit("redo", "ctrl+shift+z", "Redo"),
  letter("download", "S", "Save the picture (.png)", { kind: "download", format: "png" }),
  letter("copy_picture", "X", "Copy the picture", { kind: "copy", what: "picture" }),
  letter("copy_link", "K", "Copy a link to this view", { kind: "copy", what: "link" }),
  {
    name: "keys",
    label: "All keys",
    key: "?",
    code: "F1",
    repeats: false,
    effect: { kind: "page", command: "showKeys" },
  },
  letter("hide", "H", "Hide all but the picture", { kind: "page", command: "hideAll" }),
  letter("full", "E", "Fill the screen", { kind: "page", command: "fillScreen" }),
];

const KEY_NAMES: Record<string, string> = {
  arrowleft: "\u2190",
  arrowright: "\u2192",
  arrowup: "\u2191",
  arrowdown: "\u2193",
  delete: "Del",
  "ctrl+z": "Ctrl Z",
  "ctrl+shift+z": "Ctrl Shift Z",
  "shift+arrowleft": "Shift \u2190",
  "shift+arrowright": "Shift \u2192",
  "shift+arrowup": "Shift \u2191",
  "shift+arrowdown": "Shift \u2193",
};

/** A key as it is printed. */
export function keyName({ key }: Pick<Action, "key">): string {
  return KEY_NAMES[key] ?? key.toUpperCase();
}

/** "Reset the camera  [F]": the label for a scene, with its key as it is printed. */
export function labelWithKey(action: Pick<Action, "label" | "key">, scene: JsonObject | null = null): string {
  return `${worded(action.label, scene)}  [${keyName(action)}]`;
}

/** The action of that name; throws if there is none. */
export function actionNamed(name: string): Action {
  const action = ACTIONS.find((candidate) => candidate.name === name);
  if (!action) throw new Error(`expected one of ${ACTIONS.map((known) => known.name).join(", ")}, got ${name}`);
  return action;
}
