/** The panel's list of cuts, and sliders for the proportions of the stone's, or for how a file's design is cut anew. */

import { Choice } from "../controls/choice";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import { text } from "../json";
import type { CutKind } from "../session/catalogue";
import type { ViewState } from "../session/view-state";
import { hasStone, stoneOf, stonePatch } from "../stones/stones";
import { words } from "../words/words";
import { cutName, cutOf, cutPatch, type Proportion, proportionsOf, shapeName, shapePatch } from "./cut";
import { LiveControls } from "./live-controls";
import { type Measure, RecutSliders } from "./recut-sliders";
import type { Steps } from "./steps";
import { TierSliders } from "./tier-sliders";
import { type ListTiers, SIDES, sharing } from "./tiers";

type Send = (patch: Record<string, unknown>) => void;

export interface CutActions {
  patch: Send;
  clamped: Clamped;
  openDiagram: (stone: string) => void;
  measure: Measure;
  tiers: ListTiers;
  steps: Steps;
  keepDesign: () => void;
  changeDesigns: () => void;
  divide: () => void;
  /** The scene as the design that is kept would have it; null without another one. */
  otherwise: (scene: ViewState["scene"]) => ViewState["scene"];
}

type Values = Record<string, number>;

/** The sliders of one cut. */
class Sliders {
  readonly element = document.createElement("div");
  private readonly controls: LiveControls<Values>;

  constructor(now: () => Values, send: (name: string, value: number) => void, steps: Steps) {
    this.controls = new LiveControls(now, send, steps);
  }

  forget(): void {
    this.controls.forget();
  }

  add({ name, label, least, most, step, hint }: Proportion, clamped: Clamped): void {
    const slider = new Slider(label, { least, most, step, decimals: step < 1 ? 2 : 0 }, clamped).hint(hint);
    this.controls.listen(name, slider);
    this.element.append(slider.element);
  }

  update(shown: boolean): void {
    this.element.hidden = !shown;
    if (shown) this.controls.display();
  }
}

export class CutPanel {
  private readonly section: Section;
  private readonly clamped: Clamped;
  private readonly send: Send;
  private readonly shape: LiveControls<{ cut: string }>;
  private readonly list = new Choice<string>(words.cut.shape, [], "");
  private readonly usual: Command;
  private readonly change: Command;
  private readonly both: Command;
  private readonly otherwise: CutActions["otherwise"];
  private readonly steps: Steps;
  private readonly kinds = new Map<string, CutKind>();
  private readonly sliders = new Map<string, Sliders>();
  private readonly place: HTMLElement;
  private readonly anew: RecutSliders;
  private readonly tiers: readonly TierSliders[];
  private scene: ViewState["scene"] = null;

  constructor(
    section: Section,
    {
      patch: send,
      clamped,
      openDiagram,
      measure,
      tiers,
      steps,
      keepDesign,
      changeDesigns,
      divide,
      otherwise,
    }: CutActions,
  ) {
    this.otherwise = otherwise;
    this.steps = steps;
    this.section = section.show(false);
    this.send = send;
    this.clamped = clamped;
    this.shape = new LiveControls(
      () => ({ cut: shapeName(this.scene) }),
      (_, name) => {
        this.forgetSliders();
        send(shapePatch(this.scene, name));
      },
      steps,
    );
    this.shape.listen("cut", section.add(this.list));
    this.place = section.add({ element: document.createElement("div") }).element;
    this.anew = section.add(new RecutSliders(send, measure, clamped, steps));
    const shared = sharing(tiers);
    this.tiers = SIDES.map((side) => {
      return new TierSliders(section.section(words.cut.tiers[side]), side, send, shared, clamped, steps);
    });
    section.onFold((open) => this.anew.update(this.scene, open));
    const reset = () => {
      this.forget();
      send(stonePatch(this.scene, { cut: cutName(this.scene), recut: null }));
    };
    this.usual = section.add(new Command(words.cut.usual, reset));
    section.add(new Command(words.compare.keep, keepDesign));
    this.change = section.add(new Command(words.compare.change, changeDesigns, "A")).show(false);
    this.both = section.add(new Command(words.compare.divide, divide, "D")).show(false);
    section.add(new Command(words.grades.diagram, () => openDiagram(text(stoneOf(this.scene).id, ""))));
  }

  update({ scene }: ViewState): void {
    if (stoneOf(scene).id !== stoneOf(this.scene).id) this.forget(); // or what waits would be done to another stone
    this.scene = scene;
    this.section.show(this.kinds.size > 0 && hasStone(scene));
    this.shape.display();
    const now = cutName(scene);
    const kind = this.kinds.get(now ?? "");
    if (kind && !this.sliders.has(kind.name)) this.sliders.set(kind.name, this.slidersOf(kind));
    for (const [name, sliders] of this.sliders) sliders.update(name === now);
    this.anew.update(scene, this.section.open);
    for (const tiers of this.tiers) tiers.update(scene);
    this.usual.show(kind !== undefined);
    const differs = this.otherwise(scene) !== null;
    this.change.show(differs);
    this.both.show(differs);
  }

  /** Whether why the server refused a change is shown beside the slider that it was made with. */
  refused(why: string, field: string | undefined): boolean {
    return this.tiers.some((tiers) => tiers.refused(why, field));
  }

  /** Send nothing of what waits in a slider: something else was done to the stone. */
  forget(): void {
    this.shape.forget();
    this.forgetSliders();
  }

  private forgetSliders(): void {
    this.anew.forget();
    for (const sliders of [...this.sliders.values(), ...this.tiers]) sliders.forget();
  }

  addCuts(cuts: readonly CutKind[], state: ViewState): void {
    for (const cut of cuts) this.kinds.set(cut.name, cut);
    this.list.offer(cuts.map(({ name, title, summary }) => ({ label: title, value: name, summary })));
    this.update(state);
  }

  private slidersOf(kind: CutKind): Sliders {
    const proportions = proportionsOf(kind);
    const sliders = new Sliders(
      () => cutOf(this.scene, proportions),
      (name, value) => this.send(cutPatch(this.scene, name, value)),
      this.steps,
    );
    for (const proportion of proportions) sliders.add(proportion, this.clamped);
    this.place.append(sliders.element);
    return sliders;
  }
}
