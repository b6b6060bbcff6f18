/** What the page knows of its session: an immutable value, changed by notices. */

import { BALANCED, type Change, type JsonObject, type Notice, type State } from "@culet/protocol/messages";
import { part, text } from "../json";
import { type Wording, worded } from "../words/wording";
import { words } from "../words/words";
import type { SessionEvent, Target } from "./events";
import { withParts } from "./scene-parts";

export interface ViewState {
  target: Target;
  scene: JsonObject | null;
  /** The id of the stone that this viewer has chosen. */
  stone: string | null;
  /** Of what was told of the scene last; null before that. */
  revision: number | null;
  falling: boolean;
  /** All stones came to rest and sleep: nothing moves, though they were told to fall. */
  asleep: boolean;
  mirror: boolean;
  light: boolean;
  walls: boolean;
  /** Of moving frames: 0 many, 1 good ones. */
  exactness: number;
  /** Exactness fixes their quality instead. */
  pinned: boolean;
  /** There is an edit to undo, by whomever of the session. */
  canUndo: boolean;
  canRedo: boolean;
  viewers: number;
  /** What this viewer sends changes the session; else it only watches. */
  steers: boolean;
  engine: "down" | "up";
  /** Seconds after which the server is stopped, as it was last told; null while it is not about to be. */
  leaving: number | null;
}

export const INITIAL: ViewState = {
  target: "camera",
  scene: null,
  stone: null,
  revision: null,
  falling: false,
  asleep: false,
  mirror: false,
  light: false,
  walls: false,
  exactness: BALANCED,
  pinned: false,
  canUndo: false,
  canRedo: false,
  viewers: 1,
  steers: true,
  engine: "up",
  leaving: null,
};

export function withNotice(state: ViewState, notice: Notice): ViewState {
  switch (notice.type) {
    case "state":
      return withScene(state, notice, notice.scene);
    case "change":
      return state.scene ? withScene(state, notice, withParts(state.scene, notice.parts)) : state;
    case "viewers":
      return { ...state, viewers: notice.count };
    case "engine":
      return { ...state, engine: notice.status };
    case "leaving":
      return { ...state, leaving: notice.seconds };
    case "hello":
      return { ...state, engine: "up", leaving: null, steers: notice.steers ?? true };
    default:
      return state;
  }
}

function withScene(state: ViewState, told: State | Change, scene: JsonObject): ViewState {
  const walls = text(part(scene, "walls").kind, "none");
  return {
    ...state,
    scene,
    revision: told.revision,
    falling: told.falling,
    asleep: told.asleep ?? false,
    mirror: part(scene, "floor").kind === "mirror" || walls === "mirror",
    light: part(scene, "environment").kind === "light",
    walls: walls !== "none",
    exactness: told.exactness ?? BALANCED,
    pinned: told.pinned ?? false,
    canUndo: told.can_undo ?? false,
    canRedo: told.can_redo ?? false,
  };
}

/** Whether a notice tells of changes since another state than this one: then something of the stream was lost. */
export function isAmiss(state: ViewState, notice: Notice): boolean {
  return notice.type === "change" && notice.since !== state.revision;
}

/** Why an event would be of no use, for the user; null if it may be of some. */
export function inVain({ canUndo, canRedo }: ViewState, event: SessionEvent): string | null {
  if (event.type === "undo" && !canUndo) return words.changes.nothingToUndo;
  if (event.type === "redo" && !canRedo) return words.changes.nothingToRedo;
  return null;
}

/** What changed, in words for those who cannot see it; empty if nothing worth saying. */
export function describeChange(before: ViewState, after: ViewState): string {
  const said: string[] = [];
  if (before.target !== after.target) said.push(words.changes.moving(words.targets[after.target]));
  if (before.stone !== after.stone)
    said.push(after.stone === null ? words.changes.noneChosen : words.changes.chosen(after.stone));
  if (before.scene && after.scene) {
    if (motion(before) !== motion(after)) said.push(worded(motion(after), after.scene));
    if (before.mirror !== after.mirror) said.push(after.mirror ? words.changes.mirror : words.changes.checker);
    if (before.light !== after.light) said.push(after.light ? words.changes.lightSky : words.changes.ownSky);
    if (before.walls !== after.walls) said.push(after.walls ? words.changes.wallsShown : words.changes.wallsHidden);
    if (before.pinned !== after.pinned) said.push(after.pinned ? words.changes.pinned : words.changes.unpinned);
  }
  if (before.viewers !== after.viewers) said.push(words.status.viewers(after.viewers));
  return said.join(", ");
}

function motion({ falling, asleep }: ViewState): Wording {
  if (!falling) return words.changes.paused;
  return asleep ? words.changes.atRest : words.changes.falling;
}
