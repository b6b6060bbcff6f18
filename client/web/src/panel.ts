/** The panel: every action with its key, the state, and files. */

import { type Controller, GUI } from "lil-gui";
// By its path, since the package does not export it: a style sheet of our own origin instead of one that a script writes.
import "../node_modules/lil-gui/dist/lil-gui.css";
import { type Action, actionNamed, labelWithKey } from "./actions";
import type { CutKind } from "./catalogue";
import { ChoicePanel } from "./choice-panel";
import { CutPanel } from "./cut-panel";
import type { Target } from "./events";
import { FallPanel } from "./fall-panel";
import { type StoneActions, StonePanel } from "./stone-panel";
import { withFirst } from "./stones";
import { INITIAL, TARGET_NAMES, type ViewState } from "./view-state";
import { worded } from "./wording";

export interface PanelActions {
  perform: (action: Action) => void;
  stones: StoneActions;
  /** How many stones this viewer may put back. */
  removals: () => number;
  saveTarga: () => void;
  saveScene: () => void;
  openScene: () => void;
  openMesh: () => void;
  openSky: () => void;
  patch: (patch: Record<string, unknown>) => void;
  newSession: () => void;
}

const MOVES = ["left", "right", "up", "down", "in", "out"];
const SWITCHES = { falling: "fall", mirror: "mirror", light: "sky", walls: "walls" } as const;
const SWITCH_LABELS = { falling: "Falling", mirror: "Mirror", light: "Light sky", walls: "Walls" } as const;
const SURROUNDINGS = { one: "Stone and surroundings", several: "Stones and surroundings" };
const NARROW = 640;

export class Panel {
  readonly choices: ChoicePanel;
  readonly fall: FallPanel;
  private readonly stones: StonePanel;
  private readonly cut: CutPanel;
  private readonly gui: GUI;
  private readonly files: GUI;
  private readonly actions: PanelActions;
  private readonly shown = { target: "camera" as Target, falling: false, mirror: false, light: false, walls: false };
  private readonly displays: Controller[] = [];
  /** Those whose labels tell how many stones they act on. */
  private readonly counted: [Controller, Action][] = [];
  private readonly surroundings: GUI;
  private state: ViewState | null = null;

  constructor(container: HTMLElement, actions: PanelActions) {
    this.actions = actions;
    this.gui = new GUI({ container, title: "culet", injectStyles: false });
    this.addMoves();
    this.stones = new StonePanel(this.gui.addFolder("Stones"), actions.perform, actions.stones);
    this.surroundings = this.addSwitches();
    this.cut = new CutPanel(this.gui.addFolder("Cut").close(), actions.patch);
    this.fall = new FallPanel(this.gui.addFolder("Fall").close(), actions.patch);
    this.choices = new ChoicePanel(this.surroundings, this.gui.addFolder("Optics").close(), actions.patch);
    this.files = this.gui.addFolder("Pictures and scenes");
    this.addButton(this.files, actionNamed("download"));
    this.addCommand(this.files, "Save the picture (.tga)", () => actions.saveTarga());
    this.addCommand(this.files, "Save the scene (.json)", () => actions.saveScene());
    this.addCommand(this.files, "Open a scene\u2026", () => actions.openScene());
    this.addCommand(this.files, "Open a mesh\u2026", () => actions.openMesh());
    this.addCommand(this.files, "Open a sky\u2026", () => actions.openSky());
    this.addCommand(this.files, "New session", () => actions.newSession());
    if (window.innerWidth < NARROW) for (const folder of [this.gui, ...this.gui.folders]) folder.close();
  }

  update(state: ViewState): void {
    this.state = state;
    const { target, mirror, light, walls } = state;
    const falling = state.falling && !state.asleep;
    Object.assign(this.shown, { target, falling, mirror, light, walls });
    for (const display of this.displays) display.updateDisplay();
    for (const [button, action] of this.counted) button.name(labelWithKey(action, state.scene));
    this.surroundings.title(worded(SURROUNDINGS, state.scene));
    this.stones.update(state, this.actions.removals());
    const chosen = { ...state, scene: withFirst(state.scene, state.stone) };
    this.fall.update(chosen);
    this.cut.update(chosen);
    this.choices.update(chosen);
  }

  addCut(cut: CutKind): void {
    this.cut.addCut(cut, this.state ?? INITIAL);
  }

  private addMoves(): void {
    const folder = this.gui.addFolder("Move");
    const targets = Object.fromEntries(
      (["camera", "light_1", "light_2"] as const).map((target) => {
        return [labelWithKey({ ...actionNamed(target), label: TARGET_NAMES[target] }), target];
      }),
    );
    const target = folder.add(this.shown, "target", targets).name("What");
    target.onChange((name: Target) => this.actions.perform(actionNamed(name)));
    this.displays.push(target);
    const buttons = MOVES.map((name) => this.addButton(folder, actionNamed(name)));
    for (const button of buttons) button.domElement.classList.add("half");
    this.addButton(folder, actionNamed("reset_camera"));
  }

  private addSwitches(): GUI {
    const folder = this.gui.addFolder(SURROUNDINGS.one);
    for (const name of ["falling", "mirror", "light", "walls"] as const) {
      const action = actionNamed(SWITCHES[name]);
      const label = labelWithKey({ label: SWITCH_LABELS[name], key: action.key });
      const display = folder.add(this.shown, name).name(label);
      display.onChange(() => {
        if (this.state) this.update(this.state); // shows what is, until the server says that it changed
        this.actions.perform(action);
      });
      this.displays.push(display);
    }
    this.addButton(folder, actionNamed("reset_stone"));
    return folder;
  }

  private addButton(folder: GUI, action: Action): Controller {
    const button = this.addCommand(folder, labelWithKey(action), () => this.actions.perform(action));
    if (typeof action.label !== "string") this.counted.push([button, action]);
    return button;
  }

  private addCommand(folder: GUI, label: string, act: () => void): Controller {
    return folder.add({ act }, "act").name(label);
  }
}
