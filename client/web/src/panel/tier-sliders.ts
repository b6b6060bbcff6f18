/** A slider for the angle of each tier of a stone's crown or pavilion that can be turned for itself, all meets kept. */

import type { JsonObject } from "@culet/protocol/messages";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { type Clamped, type Ends, Slider } from "../controls/slider";
import type { TierAngle } from "../session/answers";
import { reasonOf } from "../signs/complaints";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import { Refusal } from "./refusal";
import type { Steps } from "./steps";
import { ListRequests, passes, ReachRequests } from "./tier-requests";
import {
  anglesOf,
  asTheyWerePatch,
  bodyOf,
  isOfAngles,
  kindOf,
  type ListTiers,
  othersOf,
  parted,
  type Side,
  shapeOf,
  tierPatch,
  turned,
} from "./tiers";

const DEGREES = { step: 0.05, decimals: 2 };
/** Names of facets that a label has room for. */
const MOST_NAMES = 3;

type Degrees = Record<string, number>;

interface Row {
  slider: Slider;
  /** As the server last listed it. */
  tier: TierAngle;
  /** Why the last angle was refused. */
  refusal: Refusal;
  /** A finger is on it: other ends would move it from under the finger. */
  pressed: boolean;
}

export class TierSliders {
  private readonly section: Section;
  private readonly side: Side;
  private readonly send: (patch: JsonObject) => void;
  private readonly lists: ListRequests;
  private readonly reaches: ReachRequests;
  private readonly clamped: Clamped;
  private readonly steps: Steps;
  private readonly place = document.createElement("div");
  /** Tiers that follow, or why there are none. */
  private readonly status = document.createElement("p");
  private readonly reset: Command;
  private controls: LiveControls<Degrees> | null = null;
  private readonly rows = new Map<string, Row>();
  private scene: JsonObject | null = null;
  private tiers: readonly TierAngle[] = [];
  /** The scene whose stone they are of, or which has none. */
  private listedOf: JsonObject | null = null;

  /** `steps`: an angle may take the server seconds. */
  constructor(
    section: Section,
    side: Side,
    send: (patch: JsonObject) => void,
    list: ListTiers,
    clamped: Clamped,
    steps: Steps,
  ) {
    this.section = section.fold(true);
    this.side = side;
    this.send = send;
    this.lists = new ListRequests(list, {
      listed: (tiers, of) => this.show(tiers, of),
      failed: (error, of) => this.failed(error, of),
    });
    this.reaches = new ReachRequests(list, (tier) => this.span(this.rows.get(tier)));
    this.clamped = clamped;
    this.steps = steps;
    this.status.className = "tier-status";
    this.status.setAttribute("role", "status");
    section.add({ element: this.place });
    section.add({ element: this.status });
    this.reset = section.add(
      new Command(words.cut.tiers.asTheyWere, () => {
        for (const { refusal } of this.rows.values()) refusal.hide();
        this.forget();
        send(asTheyWerePatch(this.scene, this.turned));
      }),
    );
    this.reset.show(false);
    section.onFold(() => this.look());
  }

  update(scene: JsonObject | null): void {
    this.scene = scene;
    this.section.show(shapeOf(scene) !== "");
    if (this.listedOf && kindOf(scene) !== kindOf(this.listedOf)) this.clear(); // rows of another stone would turn tiers of this one
    for (const [tier, { refusal }] of this.rows) refusal.about(othersOf(scene, tier));
    this.reset.show(this.turned.length > 0);
    this.controls?.display();
    this.look();
  }

  /** Show there why an angle of these was refused; false if it was none of these. */
  refused(why: string, field: string | undefined): boolean {
    if (!isOfAngles(field) || !this.section.open) return false;
    for (const [tier, row] of this.rows) {
      if (!row.slider.element.contains(document.activeElement)) continue;
      row.refusal.tell(why, othersOf(this.scene, tier));
      return true;
    }
    return false;
  }

  /** Turn no tier to where a slider has it but the server not yet: something else was done to the stone. */
  forget(): void {
    this.controls?.forget();
  }

  private get own(): { free: TierAngle[]; following: TierAngle[] } {
    return parted(this.tiers, this.side);
  }

  /** The tiers of this side whose angle is asked for. */
  private get turned(): string[] {
    const { free, following } = this.own;
    return turned(this.scene, [...free, ...following]);
  }

  private look(): void {
    this.lists.look(this.scene, this.section.open);
    this.reaches.look(this.scene);
    if (!this.section.open) this.useNone();
  }

  private useNone(): void {
    for (const by of ["focus", "pointer"] as const) this.reaches.use(by, null);
  }

  private failed(error: unknown, of: JsonObject): void {
    const stays = this.rows.size > 0 && bodyOf(of) === bodyOf(this.listedOf);
    if (stays && passes(error)) return; // a slider may be in use
    this.clear();
    this.listedOf = of;
    this.status.textContent = reasonOf(error);
  }

  private clear(): void {
    this.tiers = [];
    this.listedOf = null;
    this.lay([]);
    this.status.textContent = "";
    this.reset.show(false);
  }

  private show(tiers: readonly TierAngle[], of: JsonObject): void {
    const before = String(this.own.free.map(({ tier }) => tier));
    this.tiers = tiers;
    this.listedOf = of;
    const { free, following } = this.own;
    if (String(free.map(({ tier }) => tier)) !== before) this.lay(free);
    for (const tier of free) {
      const row = this.rows.get(String(tier.tier));
      if (!row) continue;
      row.tier = tier;
      row.slider.label(nameOf(tier));
      this.span(row);
    }
    this.controls?.display();
    const said = words.cut.tiers;
    const listed = following.map((tier) => said.angle(nameOf(tier), tier.degrees.toFixed(1))).join(", ");
    this.status.textContent = listed ? said.following(listed) : free.length === 0 ? said.none : "";
    this.reset.show(this.turned.length > 0);
  }

  private lay(free: readonly TierAngle[]): void {
    this.rows.clear();
    this.forget();
    this.useNone();
    this.place.replaceChildren();
    this.controls = new LiveControls<Degrees>(
      () => this.degrees(),
      (name, value) => this.send(tierPatch(this.scene, String(name), value)),
      this.steps,
    );
    for (const tier of free) this.add(String(tier.tier), tier);
  }

  private add(name: string, tier: TierAngle): void {
    const slider = new Slider(nameOf(tier), endsOf(tier), this.clamped);
    slider.element.classList.add("tier");
    const refusal = new Refusal();
    const row: Row = { slider, tier, refusal, pressed: false };
    this.rows.set(name, row);
    this.span(row);
    this.controls?.listen(name, slider);
    slider.onInput(() => refusal.hide());
    const { element } = slider;
    element.addEventListener("pointerenter", () => this.reaches.use("pointer", name));
    element.addEventListener("pointerleave", () => this.reaches.use("pointer", null));
    element.addEventListener("focusin", () => this.reaches.use("focus", name));
    element.addEventListener("focusout", ({ relatedTarget }) => {
      if (!(relatedTarget instanceof Node && element.contains(relatedTarget))) this.reaches.use("focus", null);
    });
    element.addEventListener("pointerdown", () => this.press(row));
    this.place.append(element, refusal.element);
  }

  private press(row: Row): void {
    row.pressed = true;
    const letGo = () => {
      for (const end of ["pointerup", "pointercancel"]) window.removeEventListener(end, letGo);
      row.pressed = false;
      this.span(row);
    };
    for (const end of ["pointerup", "pointercancel"]) window.addEventListener(end, letGo);
  }

  /** Give a slider the ends at which meets are kept, or what the list has where they are not known. */
  private span(row: Row | undefined): void {
    if (!row || row.pressed) return;
    const known = this.reaches.ends(String(row.tier.tier));
    const { tier, facets } = row.tier;
    row.slider.between(endsOf(known ?? row.tier)).hint(words.cut.tiers.hint(String(tier), facets, known));
  }

  /** Of the scene, or as the server last listed it. */
  private degrees(): Degrees {
    const listed = this.own.free.map(({ tier, degrees }) => [String(tier), degrees] as const);
    const asked = anglesOf(this.scene);
    return Object.fromEntries(listed.map(([tier, degrees]) => [tier, asked[tier] ?? degrees]));
  }
}

function endsOf({ least, most }: TierAngle): Ends {
  return { least, most, ...DEGREES };
}

/** By its facets' names, or else its number. */
function nameOf({ tier, names }: TierAngle): string {
  if (names.length === 0) return words.cut.tiers.unnamed(String(tier));
  const listed = names.slice(0, MOST_NAMES).join(", ") + (names.length > MOST_NAMES ? "\u2026" : "");
  return listed.replaceAll("_", "_\u200b"); // where a long name may be broken
}
