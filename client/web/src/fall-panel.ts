/** The panel's sliders and lists about the fall. They act while the stone falls. */

import type { GUI } from "lil-gui";
import type { Catalogued } from "./catalogue";
import { type Direction, type Fall, fallOf, fallPatch, MODELS, OF_RIGID, spinAxis } from "./fall";
import { LiveControls } from "./live-controls";
import { describeOptions } from "./option-titles";
import { hasStone } from "./stones";
import type { ViewState } from "./view-state";

interface Slider {
  name: keyof Fall;
  label: string;
  /** What a scene says may be beyond: then the number is right and the slider is at its end. */
  most: number;
  step: number;
  hint: string;
}

const SLIDERS: readonly Slider[] = [
  { name: "height", label: "Drop height, R", most: 8, step: 0.05, hint: "From the floor to the bounding sphere" },
  { name: "spin", label: "Spin, rad/s", most: 30, step: 0.1, hint: "At the start, about the axis that the scene has" },
  { name: "gravity", label: "Gravity, R/s\u00b2", most: 30, step: 0.1, hint: "R is the stone's radius" },
  { name: "restitution", label: "Restitution", most: 1, step: 0.01, hint: "Speed after a bounce, of that before" },
  { name: "friction", label: "Friction", most: 2, step: 0.01, hint: "Coulomb's coefficient" },
  { name: "rolling", label: "Rolling resistance", most: 0.5, step: 0.005, hint: "As a lever arm, R" },
];

export class FallPanel {
  private readonly controls: LiveControls<Fall>;
  private readonly folder: GUI;
  private scene: ViewState["scene"] = null;
  private axis: Direction | undefined;

  constructor(folder: GUI, send: (patch: Record<string, unknown>) => void) {
    this.folder = folder;
    this.controls = new LiveControls<Fall>(
      () => fallOf(this.scene),
      (name, value) => send(fallPatch(this.scene, name, value, this.axis)),
    );
    for (const slider of SLIDERS) this.addSlider(slider);
    const { shown } = this.controls;
    this.controls.listen("model", folder.add(shown, "model", MODELS).name("Model"));
    this.controls.listen("integrator", folder.add(shown, "integrator", {}).name("Integrator"));
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.axis = spinAxis(scene) ?? this.axis; // so that a spin that was taken down to 0 comes back as it was
    this.folder.show(hasStone(scene));
    this.display();
  }

  addIntegrators(integrators: Catalogued[]): void {
    const names = Object.fromEntries(integrators.map(({ name }) => [name, name]));
    const controller = this.controls.controllers.get("integrator")?.options(names);
    if (!controller) return;
    this.controls.listen("integrator", controller);
    describeOptions(controller, integrators);
    this.display();
  }

  private addSlider({ name, label, most, step, hint }: Slider): void {
    const controller = this.folder
      .add(this.controls.shown, name, 0, most, step)
      .decimals(step < 0.01 ? 3 : 2)
      .name(label);
    controller.domElement.title = hint;
    this.controls.listen(name, controller);
  }

  private display(): void {
    this.controls.display();
    for (const name of OF_RIGID) this.controls.controllers.get(name)?.enable(this.controls.shown.model === "rigid");
  }
}
