/** Everything that a key or a button does: one catalogue for keyboard, panel and tests. */

import type { JsonObject } from "@culet/protocol/messages";
import type { SessionEvent, Target } from "../session/events";
import type { Format } from "../session/rest";
import { type Wording, worded } from "../words/wording";
import { type Words, words } from "../words/words";
import type { Move } from "./moves";

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
  | { kind: "clip"; of: "last" | "next" }
  | { kind: "stones"; command: "lookAround" | "remove" | "putBack" }
  | { kind: "page"; command: "showKeys" | "hideAll" | "fillScreen" | "traceRay" | "changeDesigns" | "divide" | "fit" };

type Name = keyof Words["actions"];

export interface Action {
  name: Name;
  label: string | Wording;
  /** Letter or name printed on the key (`KeyboardEvent.key`, in lower case). */
  key: string;
  /** Where the key is on a QWERTY keyboard (`KeyboardEvent.code`). */
  code: string;
  /** Whether a key that is held down acts again. */
  repeats: boolean;
  effect: Effect;
}

function key(name: Name, key: string, code: string, effect: Effect, repeats = false): Action {
  return { name, label: words.actions[name], key, code, repeats, effect };
}

function letter(name: Name, letter: string, effect: Effect, repeats = false): Action {
  return key(name, letter.toLowerCase(), `Key${letter}`, effect, repeats);
}

function move(name: Name, code: string, move: Move): Action {
  return key(name, code.toLowerCase(), code, { kind: "move", move }, true);
}

function select(target: Target, letter: string, code: string): Action {
  return key(target, letter, code, { kind: "select", target });
}

function plain(name: Name, key: string, type: Plain): Action {
  return letter(name, key, { kind: "send", event: { type } });
}

/** By a key with Ctrl, which `keys.ts` knows: no key has such a name or place. */
function edit(type: "undo" | "redo", stroke: string): Action {
  return key(type, stroke, stroke, { kind: "send", event: { type } });
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

export const ACTIONS: readonly Action[] = [
  select("camera", "c", "KeyC"),
  select("light_1", "1", "Digit1"),
  select("light_2", "2", "Digit2"),
  select("stone", "3", "Digit3"),
  move("left", "ArrowLeft", { right: -STEP }),
  move("right", "ArrowRight", { right: STEP }),
  move("up", "ArrowUp", { up: STEP }),
  move("down", "ArrowDown", { up: -STEP }),
  letter("in", "I", dolly(STEP), true),
  letter("out", "O", dolly(-STEP), true),
  move("turn_left", "Shift+ArrowLeft", { yaw: -TURN }),
  move("turn_right", "Shift+ArrowRight", { yaw: TURN }),
  move("turn_up", "Shift+ArrowUp", { pitch: TURN }),
  move("turn_down", "Shift+ArrowDown", { pitch: -TURN }),
  plain("reset_camera", "F", "reset_camera"),
  letter("look", "V", { kind: "stones", command: "lookAround" }),
  plain("fall", "P", "toggle_fall"),
  plain("reset_stone", "R", "reset_stone"),
  plain("mirror", "M", "toggle_mirror"),
  plain("sky", "L", "toggle_environment"),
  plain("walls", "W", "toggle_walls"),
  key("remove_stone", "delete", "Delete", { kind: "stones", command: "remove" }),
  letter("put_back_stone", "U", { kind: "stones", command: "putBack" }),
  edit("undo", "ctrl+z"),
  edit("redo", "ctrl+shift+z"),
  letter("download", "S", { kind: "download", format: "png" }),
  letter("copy_picture", "X", { kind: "copy", what: "picture" }),
  letter("copy_link", "K", { kind: "copy", what: "link" }),
  letter("clip_last", "B", { kind: "clip", of: "last" }),
  letter("clip_next", "N", { kind: "clip", of: "next" }),
  letter("ray", "T", { kind: "page", command: "traceRay" }),
  letter("compare", "A", { kind: "page", command: "changeDesigns" }),
  letter("divide", "D", { kind: "page", command: "divide" }),
  key("keys", "?", "F1", { kind: "page", command: "showKeys" }),
  letter("hide", "H", { kind: "page", command: "hideAll" }),
  letter("fit", "G", { kind: "page", command: "fit" }),
  letter("full", "E", { kind: "page", command: "fillScreen" }),
];

/** A key as it is printed. */
export function keyName({ key }: Pick<Action, "key">): string {
  return words.keyNames[key] ?? key.toUpperCase();
}

/** What an action is called in a scene. */
export function labelOf(action: Pick<Action, "label">, scene: JsonObject | null = null): string {
  return worded(action.label, scene);
}

/** "Reset the camera  [F]": the label for a scene, with its key as it is printed. */
export function labelWithKey(action: Pick<Action, "label" | "key">, scene: JsonObject | null = null): string {
  return `${labelOf(action, scene)}  [${keyName(action)}]`;
}

/** The action of that name; throws if there is none. */
export function actionNamed(name: string): Action {
  const action = ACTIONS.find((candidate) => candidate.name === name);
  if (!action) throw new Error(`expected one of ${ACTIONS.map((known) => known.name).join(", ")}, got ${name}`);
  return action;
}
