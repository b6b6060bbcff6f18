/** A slider for the angle of each tier of a stone's crown or pavilion that can be turned for itself, all meets kept. */

import type { JsonObject } from "@culet/protocol/messages";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { type Clamped, type Ends, Slider } from "../controls/slider";
import type { TierAngle } from "../session/answers";
import { isPassing, ProblemError } from "../session/rest";
import { reasonOf } from "../signs/complaints";
import { words } from "../words/words";
import { LiveControls } from "./live-controls";
import {
  anglesOf,
  asTheyWerePatch,
  isOfAngles,
  type ListTiers,
  othersOf,
  parted,
  type Side,
  shapeOf,
  tierPatch,
} from "./tiers";

const DEGREES = { step: 0.05, decimals: 2 };
/** Names of facets that a label has room for. */
const MOST_NAMES = 3;

type Degrees = Record<string, number>;

interface Row {
  slider: Slider;
  /** Why the last angle was refused. */
  refusal: HTMLElement;
  /** What the ends that it has are of. */
  reach: string;
  /** A finger is on it: other ends would move it from under the finger. */
  pressed: boolean;
  /** With the ends that it gets once it is let go. */
  next: TierAngle | null;
}

export class TierSliders {
  private readonly section: Section;
  private readonly side: Side;
  private readonly send: (patch: JsonObject) => void;
  private readonly list: ListTiers;
  private readonly clamped: Clamped;
  private readonly place = document.createElement("div");
  /** Tiers that follow, or why there are none. */
  private readonly status = document.createElement("p");
  private readonly reset: Command;
  private controls: LiveControls<Degrees> | null = null;
  private readonly rows = new Map<string, Row>();
  private scene: JsonObject | null = null;
  private tiers: readonly TierAngle[] = [];
  /** What the list is of, or will be. */
  private asked = "";
  private asking = false;

  constructor(section: Section, side: Side, send: (patch: JsonObject) => void, list: ListTiers, clamped: Clamped) {
    this.section = section.fold(true);
    this.side = side;
    this.send = send;
    this.list = list;
    this.clamped = clamped;
    this.status.className = "tier-status";
    this.status.setAttribute("role", "status");
    section.add({ element: this.place });
    section.add({ element: this.status });
    this.reset = section.add(
      new Command(words.cut.tiers.asTheyWere, () => send(asTheyWerePatch(this.scene, this.own.free))),
    );
    this.reset.show(false);
    section.onFold(() => this.refresh());
  }

  update(scene: JsonObject | null): void {
    this.scene = scene;
    this.section.show(shapeOf(scene) !== "");
    this.controls?.display();
    this.refresh();
  }

  /** Show there why an angle of these was refused; false if it was none of these. */
  refused(why: string, field: string | undefined): boolean {
    if (!isOfAngles(field) || !this.section.open) return false;
    for (const { slider, refusal } of this.rows.values()) {
      if (!slider.element.contains(document.activeElement)) continue;
      refusal.textContent = why;
      refusal.hidden = false;
      return true;
    }
    return false;
  }

  private get own(): { free: TierAngle[]; following: TierAngle[] } {
    return parted(this.tiers, this.side);
  }

  /** Ask for the list of the stone as it is, once at a time, while somebody looks at it. */
  private refresh(): void {
    const shape = shapeOf(this.scene);
    if (!this.section.open || this.asking || shape === this.asked || shape === "") return;
    this.asked = shape;
    this.asking = true;
    void this.ask().finally(() => {
      this.asking = false;
      this.refresh();
    });
  }

  private async ask(): Promise<void> {
    const { scene } = this;
    try {
      this.show(await this.list(scene ?? {}, null));
    } catch (error) {
      if (this.rows.size > 0 && error instanceof ProblemError && isPassing(error)) return; // a slider may be in use
      this.show([]);
      this.status.textContent = reasonOf(error);
    }
  }

  private show(tiers: readonly TierAngle[]): void {
    const before = String(this.own.free.map(({ tier }) => tier));
    this.tiers = tiers;
    const { free, following } = this.own;
    if (String(free.map(({ tier }) => tier)) !== before) this.lay(free);
    for (const tier of free) {
      const row = this.rows.get(String(tier.tier));
      if (!row) continue;
      row.slider.label(nameOf(tier));
      if (row.reach !== othersOf(this.scene, String(tier.tier)) && !row.pressed) {
        row.reach = "";
        this.span(row, tier);
      }
      row.refusal.hidden = true;
    }
    this.controls?.display();
    const said = words.cut.tiers;
    const listed = following.map((tier) => said.angle(nameOf(tier), tier.degrees.toFixed(1))).join(", ");
    this.status.textContent = listed ? said.following(listed) : free.length === 0 ? said.none : "";
    this.reset.show(free.length > 0);
  }

  private lay(free: readonly TierAngle[]): void {
    this.rows.clear();
    this.place.replaceChildren();
    this.controls = new LiveControls<Degrees>(
      () => this.degrees(),
      (name, value) => this.send(tierPatch(this.scene, String(name), value)),
    );
    for (const tier of free) this.add(String(tier.tier), tier);
  }

  private add(name: string, tier: TierAngle): void {
    const slider = new Slider(nameOf(tier), endsOf(tier), this.clamped);
    slider.element.classList.add("tier");
    const refusal = document.createElement("p");
    refusal.className = "refusal";
    refusal.setAttribute("role", "alert");
    refusal.hidden = true;
    const row: Row = { slider, refusal, reach: "", pressed: false, next: null };
    this.rows.set(name, row);
    this.span(row, tier);
    this.controls?.listen(name, slider);
    slider.onInput(() => {
      refusal.hidden = true;
    });
    for (const about of ["pointerenter", "focusin"])
      slider.element.addEventListener(about, () => void this.askReach(name, row));
    slider.element.addEventListener("pointerdown", () => this.press(row));
    this.place.append(slider.element, refusal);
  }

  /** The ends at which meets are kept take the server a moment: those of a slider that is about to be used are asked for. */
  private async askReach(name: string, row: Row): Promise<void> {
    const { scene } = this;
    const others = othersOf(scene, name);
    if (row.reach === others) return;
    row.reach = others;
    try {
      const tier = (await this.list(scene ?? {}, name)).find((each) => String(each.tier) === name);
      if (!tier || row.reach !== others || this.rows.get(name) !== row) return;
      if (row.pressed) row.next = tier;
      else this.span(row, tier, true);
    } catch {
      row.reach = ""; // an angle beyond is refused with the server's reason
    }
  }

  private press(row: Row): void {
    row.pressed = true;
    const letGo = () => {
      for (const end of ["pointerup", "pointercancel"]) window.removeEventListener(end, letGo);
      row.pressed = false;
      if (row.next) this.span(row, row.next, true);
      row.next = null;
    };
    for (const end of ["pointerup", "pointercancel"]) window.addEventListener(end, letGo);
  }

  private span({ slider }: Row, tier: TierAngle, known = false): void {
    slider.between(endsOf(tier)).hint(words.cut.tiers.hint(String(tier.tier), tier.facets, known ? tier : null));
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
