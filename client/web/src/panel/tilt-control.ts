/** The panel's sliders for the camera's tilt, to any side, and for the head of an instrument's observer. */

import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import { headOf, instrumentOf } from "../picture/legend";
import type { ViewState } from "../session/view-state";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import { directionOf, tiltOf, tiltPatch } from "./tilt";

const DEGREES = { least: 0, most: 90, step: 0.5, decimals: 1 };
const AROUND = { least: 0, most: 360, step: 5, decimals: 1 };
const HEAD = { least: 1, most: 45, step: 0.5, decimals: 1 };

interface Stand {
  tilt: number;
  toward: number;
  head: number;
}

export class TiltControl {
  private readonly controls: LiveControls<Stand>;
  private readonly head: Slider;
  private scene: ViewState["scene"] = null;
  /** Where the camera will tilt to from straight above, where it is tilted to no side. */
  private toward = 0;

  constructor(section: Section, send: (patch: Record<string, unknown>) => void, clamped: Clamped) {
    const said = words.panel;
    this.controls = new LiveControls<Stand>(
      () => ({ tilt: tiltOf(this.scene), toward: this.toward, head: headOf(this.scene) }),
      (name, value) => send(this.patch(name, value)),
    );
    const add = (name: keyof Stand, slider: Slider, hint: string) => {
      this.controls.listen(name, section.add(slider).hint(hint));
      return slider;
    };
    add("tilt", new Slider(said.tilt, DEGREES, clamped), said.tiltHint);
    add("toward", new Slider(said.direction, AROUND, clamped), said.directionHint);
    this.head = add("head", new Slider(said.head, HEAD, clamped), said.headHint);
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    this.toward = directionOf(scene) ?? this.toward;
    this.controls.display();
    this.head.show(instrumentOf(scene) !== "");
  }

  private patch(name: keyof Stand, value: number): Record<string, unknown> {
    if (name === "head") return { environment: { head_degrees: value } };
    if (name === "toward") this.toward = value;
    return tiltPatch(this.scene, name === "tilt" ? value : tiltOf(this.scene), this.toward);
  }
}
