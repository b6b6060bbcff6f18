/** The panel's sliders and lists about the fall. They act while the stone falls. */

import { Choice } from "../controls/choice";
import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import type { Titled } from "../session/catalogue";
import type { ViewState } from "../session/view-state";
import { hasStone } from "../stones/stones";
import { words } from "../words/words";
import { type Direction, type Fall, fallOf, fallPatch, MODELS, OF_RIGID, spinAxis } from "./fall";
import { LiveControls } from "./live-controls";

type Name = "height" | "spin" | "gravity" | "restitution" | "friction" | "rolling";

interface Setting {
  name: Name;
  /** What a scene says may be beyond: then the number is right and the slider is at its end. */
  most: number;
  step: number;
}

const SLIDERS: readonly Setting[] = [
  { name: "height", most: 8, step: 0.05 },
  { name: "spin", most: 30, step: 0.1 },
  { name: "gravity", most: 30, step: 0.1 },
  { name: "restitution", most: 1, step: 0.01 },
  { name: "friction", most: 2, step: 0.01 },
  { name: "rolling", most: 0.5, step: 0.005 },
];

/** What a list is before the server said what there is to choose from. */
const NOT_KNOWN = "";

export class FallPanel {
  private readonly controls: LiveControls<Fall>;
  private readonly section: Section;
  private readonly sliders: ReadonlyMap<Name, Slider>;
  private readonly integrator = new Choice<string>(words.fall.integrator, [], NOT_KNOWN);
  private scene: ViewState["scene"] = null;
  private axis: Direction | undefined;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    this.section = section;
    this.controls = new LiveControls<Fall>(
      () => fallOf(this.scene),
      (name, value) => send(fallPatch(this.scene, name, value, this.axis)),
    );
    this.sliders = new Map(
      SLIDERS.map(({ name, most, step }) => {
        const [label, hint] = words.fall[name];
        const slider = new Slider(label, { least: 0, most, step, decimals: step < 0.01 ? 3 : 2 }, clamped);
        this.controls.listen(name, section.add(slider).hint(hint));
        return [name, slider];
      }),
    );
    this.controls.listen("model", section.add(new Choice<string>(words.fall.model, MODELS, NOT_KNOWN)));
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
