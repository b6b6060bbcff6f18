/** The panel's choices about the picture: material, sky and optics. */

import type { Controller, GUI } from "lil-gui";
import type { Catalogued, Material } from "./catalogue";
import { LiveControls } from "./live-controls";
import { describeOptions } from "./option-titles";
import {
  BANDS,
  type Choices,
  CUTOFFS,
  choicesOf,
  ENDS,
  ENDS_SAID,
  patchOf,
  SKIES,
  TONE_MAPS,
  TONE_MAPS_SAID,
} from "./scene-choices";
import { SizeControl } from "./size-control";
import { imageSky, SkyChoice } from "./sky-choice";
import { hasStone } from "./stones";
import type { ViewState } from "./view-state";

type Values = Record<string, unknown>;

const HINTS: Partial<Record<keyof Choices, string>> = {
  bands: "Wavelengths that are followed. 3: one each of red, green and blue; more spread the fire into a spectrum",
  polarised: "Follow how reflections polarise the light; without it, light is averaged at each one",
  cutoff: "Light that brings less than this part of what it began with is followed no further",
  end: "What becomes of light below the cut-off",
  toneMap: "How radiance becomes the colours of the screen",
};

export class ChoicePanel {
  private readonly controls: LiveControls<Choices>;
  private readonly skies: Values = { ...SKIES };
  private readonly size: SizeControl;
  private readonly sky = new SkyChoice();
  private scene: ViewState["scene"] = null;

  /** Material and sky go into one folder, how light is followed into another. */
  constructor(subject: GUI, optics: GUI, send: (patch: Values) => void) {
    this.controls = new LiveControls<Choices>(
      () => choicesOf(this.scene),
      (name, value) => send(name === "sky" ? this.skyPatch(value) : patchOf(this.scene, name, value)),
    );
    this.add(subject, "material", "Material", {});
    this.size = new SizeControl(subject, send);
    this.add(subject, "sky", "Sky", this.skies);
    this.add(optics, "bands", "Bands", BANDS);
    this.add(optics, "polarised", "Polarised");
    this.add(optics, "cutoff", "Cut-off", CUTOFFS);
    describeOptions(this.add(optics, "end", "Below it", ENDS), ENDS_SAID);
    describeOptions(this.add(optics, "toneMap", "Tone map", TONE_MAPS), TONE_MAPS_SAID);
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.sky.see(scene);
    this.controls.display();
    this.controls.controllers.get("material")?.show(hasStone(scene));
    this.size.update({ scene });
  }

  /** The merge patch for a sky. */
  skyPatch(sky: string): Values {
    return this.sky.patch(this.scene, sky);
  }

  /** Another scene comes. */
  forgetSky(): void {
    this.sky.forget();
  }

  addMaterials(materials: Material[]): void {
    this.offer("material", Object.fromEntries(materials.map(({ name }) => [name, name])), materials);
    this.size.setColoured(materials.filter(({ coloured }) => coloured).map(({ name }) => name));
  }

  /** Skies of the studio, or one that was uploaded under its file's name. */
  addSkies(skies: Catalogued[], id = (sky: Catalogued) => sky.name): void {
    for (const sky of skies) this.skies[sky.name] = imageSky(id(sky));
    this.offer("sky", this.skies, skies);
  }

  private add(folder: GUI, name: keyof Choices, label: string, options?: Values | number[]): Controller {
    const { shown } = this.controls;
    const controller = options ? folder.add(shown, name, options) : folder.add(shown, name);
    this.controls.listen(name, controller.name(label));
    controller.domElement.title = HINTS[name] ?? "";
    return controller;
  }

  private offer(name: keyof Choices, options: Values, described: Catalogued[]): void {
    const controller = this.controls.controllers.get(name);
    if (!controller) return;
    const renewed = controller.options(options);
    this.controls.listen(name, renewed);
    describeOptions(renewed, described);
    renewed.show(name !== "material" || hasStone(this.scene)).updateDisplay();
  }
}
