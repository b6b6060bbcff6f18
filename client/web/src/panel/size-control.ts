/** The panel's slider for the stone's size; shown while a colour depends on it. */

import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import type { ViewState } from "../session/view-state";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import { sizeMatters, sizeOf, sizePatch } from "./scene-choices";

const ENDS_MM = { least: 0.5, most: 12, step: 0.05, decimals: 2 };

export class SizeControl {
  private readonly controls: LiveControls<{ size: number }>;
  private readonly slider: Slider;
  private coloured: ReadonlySet<string> = new Set();
  private scene: ViewState["scene"] = null;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    this.controls = new LiveControls(
      () => ({ size: sizeOf(this.scene) }),
      (_, value) => send(sizePatch(Number(value))),
    );
    this.slider = section
      .add(new Slider(words.material.radius, ENDS_MM, clamped))
      .hint(words.material.radiusHint)
      .show(false);
    this.controls.listen("size", this.slider);
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    this.controls.display();
    this.slider.show(sizeMatters(scene, this.coloured));
  }

  /** The names of the materials that absorb by a spectrum of their own. */
  setColoured(names: Iterable<string>): void {
    this.coloured = new Set(names);
    this.update({ scene: this.scene });
  }
}
