/** The panel's controls of floor and walls, and of the light that stones throw onto them. */

import { Colour } from "../controls/colour";
import type { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import { Toggle } from "../controls/toggle";
import type { ViewState } from "../session/view-state";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import {
  BARE,
  causticsPatch,
  isMatte,
  PLACES,
  type Surface,
  type SurfaceName,
  showsCaustics,
  surfaceOf,
  surfacePatch,
  throwsCaustics,
} from "./surfaces";

type Send = (patch: Record<string, unknown>) => void;

const CELL_ENDS = { least: 0.1, most: 8, step: 0.05, decimals: 2 };

export class SurfacePanel {
  private readonly caustics: LiveControls<{ caustics: boolean }>;
  private readonly toggle: Toggle;
  private readonly surfaces: readonly OneSurface[];
  private scene: ViewState["scene"] = null;

  constructor(surroundings: Section, surfaces: Section, send: Send, clamped: Clamped) {
    this.caustics = new LiveControls(
      () => ({ caustics: throwsCaustics(this.scene) }),
      (_, value) => send(causticsPatch(value)),
    );
    this.toggle = surroundings.add(new Toggle(words.optics.caustics));
    this.caustics.listen("caustics", this.toggle);
    this.surfaces = PLACES.map((place) => new OneSurface(place, surfaces, send, clamped));
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    const shown = showsCaustics(scene);
    this.caustics.display();
    this.toggle.enable(shown).hint(shown ? words.optics.causticsHint : words.optics.noCausticsHint);
    for (const surface of this.surfaces) surface.update({ scene });
  }
}

class OneSurface {
  private readonly place: SurfaceName;
  private readonly controls: LiveControls<Surface>;
  private readonly albedo: Colour;
  private readonly checkered: Toggle;
  private readonly cell: Slider;
  private readonly other: Colour;
  private scene: ViewState["scene"] = null;
  /** The last checker that there was. */
  private checker: Pick<Surface, "cell" | "other"> = BARE;

  constructor(place: SurfaceName, section: Section, send: Send, clamped: Clamped) {
    this.place = place;
    this.controls = new LiveControls<Surface>(
      () => surfaceOf(this.scene, place),
      (name, value) => send(surfacePatch(place, name, value, this.checker)),
    );
    const said = words.surfaces;
    const title = said[place];
    this.albedo = section.add(new Colour(title));
    this.checkered = section.add(new Toggle(said.checkered(title))).hint(said.checkeredHint);
    this.cell = section.add(new Slider(said.cell(title), CELL_ENDS, clamped)).hint(said.cellHint);
    this.other = section.add(new Colour(said.other(title))).hint(said.otherHint);
    this.controls.listen("albedo", this.albedo);
    this.controls.listen("checkered", this.checkered);
    this.controls.listen("cell", this.cell);
    this.controls.listen("other", this.other);
  }

  update({ scene }: Pick<ViewState, "scene">): void {
    this.scene = scene;
    const { checkered, cell, other } = surfaceOf(scene, this.place);
    if (checkered) this.checker = { cell, other };
    this.controls.display();
    const matte = isMatte(scene, this.place);
    this.albedo.enable(matte).hint(matte ? words.surfaces.albedoHint : words.surfaces.notMatte);
    this.checkered.enable(matte);
    for (const control of [this.cell, this.other]) control.enable(matte && checkered);
  }
}
