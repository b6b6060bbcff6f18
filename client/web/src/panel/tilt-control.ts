/** The panel's slider for the camera's tilt: cutters look face up, and a few degrees from there. */

import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import type { ViewState } from "../session/view-state";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import { tiltOf, tiltPatch } from "./tilt";

const DEGREES = { least: 0, most: 90, step: 0.5, decimals: 1 };

export class TiltControl {
  private readonly controls: LiveControls<{ tilt: number }>;
  private scene: ViewState["scene"] = null;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    this.controls = new LiveControls(
      () => ({ tilt: tiltOf(this.scene) }),
      (_, value) => send(tiltPatch(this.scene, Number(value))),
    );
    this.controls.listen(
      "tilt",
      section.add(new Slider(words.panel.tilt, DEGREES, clamped)).hint(words.panel.tiltHint),
    );
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    this.controls.display();
  }
}
