/** The panel's sliders for the proportions of the stone's cut; hidden for a mesh, which has none. */

import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import type { CutKind } from "../session/catalogue";
import type { ViewState } from "../session/view-state";
import { stonePatch } from "../stones/stones";
import { words } from "../words/words";
import { cutName, cutOf, cutPatch, type Proportion, proportionsOf } from "./cut";
import { LiveControls } from "./live-controls";

const STEP = 0.05;

export class CutPanel {
  private readonly section: Section;
  private readonly clamped: Clamped;
  private readonly send: (patch: Record<string, unknown>) => void;
  private controls: LiveControls<Record<string, number>> | null = null;
  private cut = "";
  private scene: ViewState["scene"] = null;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    this.section = section.show(false);
    this.send = send;
    this.clamped = clamped;
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.section.show(this.controls !== null && cutName(scene) === this.cut);
    this.controls?.display();
  }

  addCut(cut: CutKind, state: ViewState): void {
    const proportions = proportionsOf(cut);
    this.cut = cut.name;
    this.controls = new LiveControls(
      () => cutOf(this.scene, proportions),
      (name, value) => this.send(cutPatch(this.scene, name, value)),
    );
    for (const proportion of proportions) this.addSlider(this.controls, proportion);
    const reset = () => this.send(stonePatch(this.scene, { cut: cut.name }));
    this.section.add(new Command(words.cut.usual, reset));
    this.update(state);
  }

  private addSlider(controls: LiveControls<Record<string, number>>, { name, label, least, most, hint }: Proportion) {
    const slider = new Slider(label, { least, most, step: STEP, decimals: 2 }, this.clamped);
    controls.listen(name, this.section.add(slider).hint(hint));
  }
}
