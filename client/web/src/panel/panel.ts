/** The panel: every action with its key, the state, and files. What most want is first, numbers and optics are last. */

import "../controls/controls.css";
import { Choice } from "../controls/choice";
import { Command } from "../controls/command";
import { Hints } from "../controls/hints";
import { Row } from "../controls/row";
import { Section } from "../controls/section";
import { Toggle } from "../controls/toggle";
import { FORMATS } from "../files/saving";
import { type Action, actionNamed, keyName, labelOf, labelWithKey } from "../input/actions";
import type { CutKind } from "../session/catalogue";
import type { Target } from "../session/events";
import type { Format } from "../session/rest";
import { INITIAL, type ViewState } from "../session/view-state";
import { withFirst } from "../stones/stones";
import { worded } from "../words/wording";
import { words } from "../words/words";
import { ChoicePanel } from "./choice-panel";
import { CutPanel } from "./cut-panel";
import { EditButtons } from "./edit-buttons";
import { FallPanel } from "./fall-panel";
import { type Ask, GradePanel } from "./grade-panel";
import type { Measure } from "./recut-sliders";
import type { Steps } from "./steps";
import { type StoneActions, StonePanel } from "./stone-panel";
import { SurfacePanel } from "./surface-panel";
import type { ListTiers } from "./tiers";
import { TiltControl } from "./tilt-control";

export interface PanelActions {
  perform: (action: Action) => void;
  stones: StoneActions;
  /** How many stones this viewer may put back. */
  removals: () => number;
  savePicture: (format: Format) => void;
  saveScene: () => void;
  openScene: () => void;
  openMesh: () => void;
  openSky: () => void;
  patch: (patch: Record<string, unknown>) => void;
  newSession: () => void;
  /** Ask for a stone's grades. */
  grades: Ask;
  /** Keep the chosen stone's design, to compare others with. */
  keepDesign: () => void;
  /** Show the design that is kept, and keep the one that is shown. */
  changeDesigns: () => void;
  /** Show both designs with a divider, or the one alone. */
  divide: () => void;
  /** The scene as the design would have it that this one is compared with; null without one. */
  otherwise: (scene: ViewState["scene"]) => ViewState["scene"];
  /** Ask for a stone's proportions. */
  measure: Measure;
  /** Ask for a stone's tiers. */
  tiers: ListTiers;
  /** What may take the server seconds is asked for so. */
  steps: Steps;
  /** Show a stone's cutting diagram. */
  openDiagram: (stone: string) => void;
  /** Show the session's links. */
  share: () => void;
  /** A number was typed that is beyond a slider's ends. */
  clamped: (typed: number, taken: number) => void;
}

const MOVES = ["left", "right", "up", "down", "in", "out", "turn_left", "turn_right", "turn_up", "turn_down"];
const TARGETS = ["camera", "light_1", "light_2", "stone"] as const;
const NARROW = 640;

type Shown = Pick<ViewState, "falling" | "mirror" | "light" | "walls">;

export class Panel {
  readonly choices: ChoicePanel;
  readonly fall: FallPanel;
  private readonly edits: EditButtons;
  private readonly stones: StonePanel;
  private readonly cut: CutPanel;
  private readonly grades: GradePanel;
  private readonly surfaces: SurfacePanel;
  private readonly tilt: TiltControl;
  private readonly actions: PanelActions;
  private readonly target: Choice<Target>;
  private readonly toggles: [keyof Shown, Toggle][] = [];
  /** Those whose labels tell how many stones they act on. */
  private readonly counted: [Command, Action][] = [];
  private readonly root: Section;
  private readonly stone: Section;
  private clip: Command | null = null;
  private state: ViewState | null = null;

  constructor(container: HTMLElement, actions: PanelActions) {
    this.actions = actions;
    const said = words.panel;
    const root = new Section(said.title, 1);
    this.root = root;
    this.edits = root.add(new EditButtons(actions.perform));
    const stone = root.section(said.stone.one);
    const surroundings = root.section(said.surroundings);
    const files = root.section(said.files);
    const move = root.section(said.move);
    const cut = root.section(said.cut).fold(true);
    const grades = root.section(words.grades.title).fold(true);
    const fall = root.section(said.fall).fold(true);
    const surfaces = root.section(said.surfaces).fold(true);
    const optics = root.section(said.optics).fold(true);
    const page = root.section(said.page);
    this.stone = stone;
    this.choices = new ChoicePanel({ stone, surroundings, optics }, actions.patch, actions.clamped);
    this.addToggle(stone, "falling", "fall", said.falling);
    this.addButton(stone, actionNamed("reset_stone"));
    this.stones = new StonePanel(stone, actions.perform, actions.stones);
    this.addToggle(surroundings, "mirror", "mirror", said.mirror);
    this.addToggle(surroundings, "light", "sky", said.lightSky);
    this.addToggle(surroundings, "walls", "walls", said.walls);
    this.surfaces = new SurfacePanel(surroundings, surfaces, actions.patch, actions.clamped);
    this.target = this.addMoves(move);
    this.tilt = new TiltControl(move, actions.patch, actions.clamped);
    this.cut = new CutPanel(cut, actions);
    this.grades = new GradePanel(grades, actions.grades, actions.otherwise);
    this.fall = new FallPanel(fall, actions.patch, actions.clamped);
    this.addFiles(files);
    this.addButton(stone, actionNamed("ray"));
    this.addButton(page, actionNamed("keys"));
    this.addButton(page, actionNamed("hide"));
    this.addButton(page, actionNamed("full")).show(document.fullscreenEnabled);
    if (window.innerWidth < NARROW) {
      for (const section of [root, stone, surroundings, move, files, page]) section.fold(true);
    }
    root.element.append(new Hints(root.element).element);
    container.append(root.element);
  }

  update(state: ViewState): void {
    this.state = state;
    const shown = { ...state, falling: state.falling && !state.asleep };
    this.edits.update(state);
    this.target.value = state.target;
    for (const [name, toggle] of this.toggles) toggle.value = shown[name];
    for (const [button, action] of this.counted) button.label(labelOf(action, state.scene));
    this.stone.title(worded(words.panel.stone, state.scene));
    this.stones.update(state, this.actions.removals());
    this.tilt.update(state);
    const chosen = { ...state, scene: withFirst(state.scene, state.stone) };
    this.fall.update(chosen);
    this.cut.update(chosen);
    this.grades.update(chosen);
    this.choices.update(chosen);
    this.surfaces.update(chosen);
  }

  /** The next seconds are being recorded, or not any more. */
  recording(on: boolean): void {
    const { clip, files } = words;
    this.clip?.label(on ? files.stop : files.nextSeconds);
    this.clip?.name(on ? clip.stopRecording : labelOf(actionNamed("clip_next")));
  }

  /** On a narrow window the open panel lies where the table of a ray is to be. */
  makeRoom(): void {
    if (window.innerWidth < NARROW) this.root.fold(true);
  }

  /** Send nothing of what waits in a slider: something else was done to the stone. */
  forget(): void {
    this.cut.forget();
  }

  /** Whether a refusal is shown in the panel, where the change was made. */
  refused(why: string, field: string | undefined): boolean {
    return this.cut.refused(why, field);
  }

  addCuts(cuts: readonly CutKind[]): void {
    this.cut.addCuts(cuts, this.state ?? INITIAL);
  }

  private addMoves(section: Section): Choice<Target> {
    const options = TARGETS.map((target) => {
      return { label: labelWithKey({ ...actionNamed(target), label: words.targets[target] }), value: target };
    });
    const target = section.add(new Choice<Target>(words.panel.moved, options, "camera"));
    target.onInput((name) => this.actions.perform(actionNamed(name)));
    for (const name of MOVES) this.addButton(section, actionNamed(name)).element.classList.add("half");
    this.addButton(section, actionNamed("look"));
    this.addButton(section, actionNamed("reset_camera"));
    return target;
  }

  private addFiles(section: Section): void {
    const { panel: said, files } = words;
    const row = (label: string) => section.add(new Row(label));
    const acting = (to: Row, name: string, seen: string) => {
      const action = actionNamed(name);
      return to.add(seen, labelOf(action), () => this.actions.perform(action), keyName(action));
    };
    const pictures = row(files.picture);
    acting(pictures, "download", "PNG");
    for (const [format, seen, label] of FORMATS) pictures.add(seen, label, () => this.actions.savePicture(format));
    const copies = row(files.copy);
    acting(copies, "copy_picture", files.copiedPicture);
    acting(copies, "copy_link", files.copiedLink);
    const clips = row(files.clip);
    acting(clips, "clip_last", files.lastSeconds);
    this.clip = acting(clips, "clip_next", files.nextSeconds);
    const scenes = row(files.scene);
    scenes.add(files.save, said.saveScene, () => this.actions.saveScene());
    scenes.add(files.open, said.openScene, () => this.actions.openScene());
    const opens = row(files.openRow);
    opens.add(files.mesh, said.openMesh, () => this.actions.openMesh());
    opens.add(files.sky, said.openSky, () => this.actions.openSky());
    section.add(new Command(said.share, () => this.actions.share()));
    section.add(new Command(said.newSession, () => this.actions.newSession()));
  }

  private addToggle(section: Section, name: keyof Shown, command: string, label: string): void {
    const action = actionNamed(command);
    const toggle = section.add(new Toggle(label).key(keyName(action)));
    toggle.onInput(() => {
      if (this.state) this.update(this.state); // shows what is, until the server says that it changed
      this.actions.perform(action);
    });
    this.toggles.push([name, toggle]);
  }

  private addButton(section: Section, action: Action): Command {
    const button = section.add(new Command(labelOf(action), () => this.actions.perform(action), keyName(action)));
    if (typeof action.label !== "string") this.counted.push([button, action]);
    return button;
  }
}
