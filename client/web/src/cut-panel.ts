/** The panel's sliders for the proportions of the stone's cut; hidden for a mesh, which has none. */

import type { GUI } from "lil-gui";
import type { CutKind } from "./catalogue";
import { cutName, cutOf, cutPatch, type Proportion, proportionsOf } from "./cut";
import { LiveControls } from "./live-controls";
import { stonePatch } from "./stones";
import type { ViewState } from "./view-state";

const STEP = 0.05;

export class CutPanel {
  private readonly folder: GUI;
  private readonly send: (patch: Record<string, unknown>) => void;
  private controls: LiveControls<Record<string, number>> | null = null;
  private cut = "";
  private scene: ViewState["scene"] = null;

  constructor(folder: GUI, send: (patch: Record<string, unknown>) => void) {
    this.folder = folder.hide();
    this.send = send;
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.folder.show(this.controls !== null && cutName(scene) === this.cut);
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
    this.folder.add({ reset }, "reset").name("The usual proportions");
    this.update(state);
  }

  private addSlider(controls: LiveControls<Record<string, number>>, { name, label, least, most, hint }: Proportion) {
    const controller = this.folder.add(controls.shown, name, least, most, STEP).decimals(2).name(label);
    controller.domElement.title = hint;
    controls.listen(name, controller);
  }
}
