/** The panel's slider for the stone's size; shown while a colour depends on it. */

import type { Controller, GUI } from "lil-gui";
import { LiveControls } from "./live-controls";
import { sizeMatters, sizeOf, sizePatch } from "./scene-choices";
import type { ViewState } from "./view-state";

const LEAST_MM = 0.5;
const MOST_MM = 12;
const STEP_MM = 0.05;
const HINT = "Of the girdle: the longer the ways through the stone, the deeper its colour. One carat is 3.25 mm";

export class SizeControl {
  private readonly controls: LiveControls<{ size: number }>;
  private readonly controller: Controller;
  private coloured: ReadonlySet<string> = new Set();
  private scene: ViewState["scene"] = null;

  constructor(folder: GUI, send: (patch: Record<string, unknown>) => void) {
    this.controls = new LiveControls(
      () => ({ size: sizeOf(this.scene) }),
      (_, value) => send(sizePatch(Number(value))),
    );
    this.controller = folder.add(this.controls.shown, "size", LEAST_MM, MOST_MM, STEP_MM).decimals(2);
    this.controller.name("Radius, mm").hide().domElement.title = HINT;
    this.controls.listen("size", this.controller);
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    this.controls.display();
    this.controller.show(sizeMatters(scene, this.coloured));
  }

  /** The names of the materials that absorb by a spectrum of their own. */
  setColoured(names: Iterable<string>): void {
    this.coloured = new Set(names);
    this.update({ scene: this.scene });
  }
}
