/** The panel's choices about the picture: material, sky and optics. */

import { Choice, type Option } from "../controls/choice";
import type { Section } from "../controls/section";
import type { Clamped } from "../controls/slider";
import { Toggle } from "../controls/toggle";
import type { MaterialChoice, Titled } from "../session/catalogue";
import type { ViewState } from "../session/view-state";
import { hasStone } from "../stones/stones";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import {
  BANDS,
  type Bands,
  type Choices,
  CUTOFFS,
  choicesOf,
  ENDS,
  indicesOf,
  materialFacts,
  materialOption,
  NOTHING_CHOSEN,
  OWN_INDICES,
  patchOf,
  SKIES,
  TONE_MAPS,
} from "./scene-choices";
import { SizeControl } from "./size-control";
import { imageSky, SkyChoice } from "./sky-choice";

type Values = Record<string, unknown>;

/** The sections of the panel that the choices go into: about the stone, about what is around it, and how light is followed. */
export interface Sections {
  stone: Section;
  surroundings: Section;
  optics: Section;
}

export class ChoicePanel {
  private readonly controls: LiveControls<Choices>;
  private readonly material = new Choice<string>(words.material.label, [OWN_INDICES], NOTHING_CHOSEN.material);
  private readonly sky = new Choice<string>(words.skies.label, SKIES, NOTHING_CHOSEN.sky);
  private readonly facts = document.createElement("p");
  private materials: readonly MaterialChoice[] = [];
  private readonly size: SizeControl;
  private readonly studio = new SkyChoice();
  private skies: readonly Option<string>[] = SKIES;
  private scene: ViewState["scene"] = null;

  constructor({ stone, surroundings, optics }: Sections, send: (patch: Values) => void, clamped: Clamped) {
    this.controls = new LiveControls<Choices>(
      () => choicesOf(this.scene),
      (name, value) => send(name === "sky" ? this.skyPatch(String(value)) : patchOf(this.scene, name, value)),
    );
    this.controls.listen("material", stone.add(this.material));
    this.facts.className = "facts";
    this.facts.dataset.hint = words.material.factsHint;
    this.facts.tabIndex = 0; // what the numbers mean is said to the keyboard too
    stone.body.append(this.facts);
    this.size = new SizeControl(stone, send, clamped);
    this.controls.listen("sky", surroundings.add(this.sky));
    const numbers = (values: readonly number[]) => values.map((value) => ({ label: String(value), value }));
    const said = words.optics;
    const none = NOTHING_CHOSEN;
    this.controls.listen("bands", optics.add(new Choice<Bands>(said.bands, BANDS, none.bands)).hint(said.bandsHint));
    this.controls.listen("polarised", optics.add(new Toggle(said.polarised)).hint(said.polarisedHint));
    this.controls.listen(
      "cutoff",
      optics.add(new Choice(said.cutoff, numbers(CUTOFFS), none.cutoff)).hint(said.cutoffHint),
    );
    this.controls.listen("end", optics.add(new Choice(said.end, ENDS, none.end)).hint(said.endHint));
    this.controls.listen(
      "toneMap",
      optics.add(new Choice(said.toneMap, TONE_MAPS, none.toneMap)).hint(said.toneMapHint),
    );
    const hide = new Toggle(said.hideFireflies).hint(said.hideFirefliesHint);
    this.controls.listen("hideFireflies", optics.add(hide));
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.studio.see(scene);
    this.controls.display();
    this.material.show(hasStone(scene));
    this.showFacts();
    this.size.update({ scene });
  }

  private showFacts(): void {
    const indices = indicesOf(this.scene, this.materials);
    this.facts.hidden = indices === null;
    const said = indices ? materialFacts(indices) : "";
    if (this.facts.textContent !== said) this.facts.textContent = said;
  }

  /** The merge patch for a sky. */
  skyPatch(sky: string): Values {
    return this.studio.patch(this.scene, sky);
  }

  /** Another scene comes. */
  forgetSky(): void {
    this.studio.forget();
  }

  addMaterials(materials: readonly MaterialChoice[]): void {
    this.materials = materials;
    this.showFacts();
    this.material.offer(materials.map((material) => materialOption(material)));
    this.size.setColoured(materials.filter(({ coloured }) => coloured).map(({ name }) => name));
  }

  /** Skies of the studio, or one that was uploaded: its title is its file's name. */
  addSkies(skies: readonly Titled[]): void {
    const offered = skies.map(({ name, title, summary }) => ({ label: title, value: imageSky(name), summary }));
    this.skies = [...this.skies, ...offered];
    this.sky.offer(this.skies);
  }
}
