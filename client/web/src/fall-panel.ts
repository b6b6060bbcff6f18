/** The panel's sliders and lists about the fall. They act while the stone falls. */

import type { Titled } from "./catalogue";
import { Choice, optionsOf } from "./controls/choice";
import type { Section } from "./controls/section";
import { type Clamped, Slider } from "./controls/slider";
import { type Direction, type Fall, fallOf, fallPatch, MODELS, OF_RIGID, spinAxis } from "./fall";
import { LiveControls } from "./live-controls";
import { hasStone } from "./stones";
import type { ViewState } from "./view-state";

type Name = "height" | "spin" | "gravity" | "restitution" | "friction" | "rolling";

interface Setting {
  name: Name;
  label: string;
  /** What a scene says may be beyond: then the number is right and the slider is at its end. */
  most: number;
  step: number;
  hint: string;
}

const SLIDERS: readonly Setting[] = [
  { name: "height", label: "Drop height, R", most: 8, step: 0.05, hint: "From the floor to the bounding sphere" },
  { name: "spin", label: "Spin, rad/s", most: 30, step: 0.1, hint: "At the start, about the axis that the scene has" },
  { name: "gravity", label: "Gravity, R/s\u00b2", most: 30, step: 0.1, hint: "R is the stone's radius" },
  { name: "restitution", label: "Restitution", most: 1, step: 0.01, hint: "Speed after a bounce, of that before" },
  { name: "friction", label: "Friction", most: 2, step: 0.01, hint: "Coulomb's coefficient" },
  { name: "rolling", label: "Rolling resistance", most: 0.5, step: 0.005, hint: "As a lever arm, R" },
];

/** What a list is before the server said what there is to choose from. */
const NOT_KNOWN = "";

export class FallPanel {
  private readonly controls: LiveControls<Fall>;
  private readonly section: Section;
  private readonly sliders: ReadonlyMap<Name, Slider>;
  private readonly integrator = new Choice<string>("Integrator", [], NOT_KNOWN);
  private scene: ViewState["scene"] = null;
  private axis: Direction | undefined;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    this.section = section;
    this.controls = new LiveControls<Fall>(
      () => fallOf(this.scene),
      (name, value) => send(fallPatch(this.scene, name, value, this.axis)),
    );
    this.sliders = new Map(
      SLIDERS.map(({ name, label, most, step, hint }) => {
        const slider = new Slider(label, { least: 0, most, step, decimals: step < 0.01 ? 3 : 2 }, clamped);
        this.controls.listen(name, section.add(slider).hint(hint));
        return [name, slider];
      }),
    );
    this.controls.listen("model", section.add(new Choice<string>("Model", optionsOf(MODELS), NOT_KNOWN)));
    this.controls.listen("integrator", section.add(this.integrator));
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.axis = spinAxis(scene) ?? this.axis; // so that a spin that was taken down to 0 comes back as it was
    this.section.show(hasStone(scene));
    this.controls.display();
    const rigid = this.controls.shown.model === "rigid";
    for (const name of OF_RIGID) (name === "integrator" ? this.integrator : this.sliders.get(name))?.enable(rigid);
  }

  addIntegrators(integrators: readonly Titled[]): void {
    this.integrator.offer(integrators.map(({ name, title, summary }) => ({ label: title, value: name, summary })));
  }
}
