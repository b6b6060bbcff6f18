/** The panel's sliders and lists about the fall. They act while the stone falls, once a picture at most. */

import type { Controller, GUI } from "lil-gui";
import { type Direction, type Fall, fallOf, fallPatch, MODELS, NOTHING_FALLS, OF_RIGID, spinAxis } from "./fall";
import type { Catalogued } from "./rest";
import type { ViewState } from "./view-state";

type Values = Record<string, unknown>;

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

/** For so long after it was let go, a slider stays where it is: what the server says of it may still be on its way. */
const ECHO_MS = 500;

export class FallPanel {
  private readonly shown: Fall = { ...NOTHING_FALLS };
  private readonly controllers = new Map<keyof Fall, Controller>();
  /** Show where the finger is or was, not what the server last said; with the timer that ends this, if let go. */
  private readonly held = new Map<keyof Fall, ReturnType<typeof setTimeout> | undefined>();
  private readonly waiting = new Map<keyof Fall, never>();
  private readonly folder: GUI;
  private readonly send: (patch: Values) => void;
  private scene: ViewState["scene"] = null;
  private axis: Direction | undefined;

  constructor(folder: GUI, send: (patch: Values) => void) {
    this.folder = folder;
    this.send = send;
    for (const slider of SLIDERS) this.addSlider(slider);
    this.listen("model", folder.add(this.shown, "model", MODELS).name("Model"));
    this.listen("integrator", folder.add(this.shown, "integrator", {}).name("Integrator"));
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.axis = spinAxis(scene) ?? this.axis; // so that a spin that was taken down to 0 comes back as it was
    this.display();
  }

  addIntegrators(integrators: Catalogued[]): void {
    const names = Object.fromEntries(integrators.map(({ name }) => [name, name]));
    const controller = this.controllers.get("integrator")?.options(names);
    if (!controller) return;
    this.listen("integrator", controller);
    for (const option of controller.domElement.querySelectorAll("option")) {
      option.title = integrators.find(({ name }) => name === option.textContent)?.summary ?? "";
    }
    this.display();
  }

  private addSlider({ name, label, most, step, hint }: Slider): void {
    const controller = this.folder
      .add(this.shown, name, 0, most, step)
      .decimals(step < 0.01 ? 3 : 2)
      .name(label);
    controller.domElement.title = hint;
    this.listen(name, controller);
    controller.onFinishChange(() => this.letGo(name));
  }

  private listen(name: keyof Fall, controller: Controller): void {
    this.controllers.set(name, controller);
    controller.onChange((value: never) => {
      const list = controller.domElement.querySelector("select");
      list?.blur(); // or the next key would choose something else
      if (!list) this.hold(name);
      this.display(); // what is not held shows what is, until the server says that it changed
      if (this.waiting.size === 0) requestAnimationFrame(() => this.flush());
      this.waiting.set(name, value);
    });
  }

  private hold(name: keyof Fall, timer?: ReturnType<typeof setTimeout>): void {
    clearTimeout(this.held.get(name));
    this.held.set(name, timer);
  }

  private letGo(name: keyof Fall): void {
    const end = () => {
      this.held.delete(name);
      this.display();
    };
    this.hold(name, setTimeout(end, ECHO_MS));
  }

  private flush(): void {
    for (const [name, value] of this.waiting) this.send(fallPatch(this.scene, name, value, this.axis));
    this.waiting.clear();
  }

  private display(): void {
    const now = fallOf(this.scene);
    for (const name of this.held.keys()) now[name] = this.shown[name] as never;
    Object.assign(this.shown, now);
    for (const [name, controller] of this.controllers) {
      controller.updateDisplay();
      if (OF_RIGID.includes(name)) controller.enable(now.model === "rigid");
    }
  }
}
