/** Sliders for the design of a file: crown and pavilion steeper with all meets kept, girdle and table. */

import type { JsonObject } from "@culet/protocol/messages";
import { Command } from "../controls/command";
import { type Clamped, type Ends, Slider } from "../controls/slider";
import type { Proportions } from "../session/answers";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import { asItCame, asItCamePatch, type Own, type Recut, recutOf, recutPatch, uploadOf } from "./recut";
import type { Steps } from "./steps";

const RATIO: Ends = { least: 0.8, most: 1.25, step: 0.005, decimals: 3 };
const ENDS: Record<keyof Recut, Ends> = {
  crown_ratio: RATIO,
  pavilion_ratio: RATIO,
  girdle_percent: { least: 0.5, most: 12, step: 0.1, decimals: 2 },
  table_percent: { least: 20, most: 90, step: 0.5, decimals: 2 },
};
const NAMES = Object.keys(ENDS) as (keyof Recut)[];

/** The server's answer for the only stone of a scene. */
export type Measure = (scene: JsonObject) => Promise<Proportions>;

export class RecutSliders {
  readonly element = document.createElement("div");
  private readonly controls: LiveControls<Recut>;
  private readonly measure: Measure;
  private scene: JsonObject | null = null;
  /** The upload that was measured last, and how it is. */
  private measured = "";
  private own: Own | null = null;

  constructor(send: (patch: Record<string, unknown>) => void, measure: Measure, clamped: Clamped, steps: Steps) {
    this.measure = measure;
    this.controls = new LiveControls<Recut>(
      () => recutOf(this.scene, this.own),
      (name, value) => send(recutPatch(this.scene, name, value)),
      steps,
    );
    for (const name of NAMES) {
      const [label, hint] = words.cut.anew[name];
      const slider = new Slider(label, ENDS[name], clamped).hint(hint);
      this.controls.listen(name, slider);
      this.element.append(slider.element);
    }
    const asItWas = () => {
      this.forget();
      send(asItCamePatch(this.scene));
    };
    this.element.append(new Command(words.cut.asItCame, asItWas).element);
    this.element.hidden = true;
  }

  /** Send nothing of what waits: something else was done to the stone. */
  forget(): void {
    this.controls.forget();
  }

  /** `seen`: somebody looks at the panel's part that these are in. */
  update(scene: JsonObject | null, seen: boolean): void {
    this.scene = scene;
    const upload = uploadOf(scene);
    this.element.hidden = upload === "";
    if (upload === "") return;
    if (seen && upload !== this.measured) void this.ask(upload);
    this.controls.display();
  }

  /** A shape that cannot be measured, as one that is not convex, leaves girdle and table without a number. */
  private async ask(upload: string): Promise<void> {
    this.measured = upload;
    this.own = null;
    try {
      const own = await this.measure(asItCame(this.scene));
      if (this.measured !== upload) return;
      this.own = own;
      this.controls.display();
    } catch {
      // A move of a slider is refused with the server's reason.
    }
  }
}
