/** What a viewer does to the stones of the scene: add, remove, put back, scatter. */

import type { JsonObject } from "@culet/protocol/messages";
import type { SessionEvent } from "../session/events";
import type { ViewState } from "../session/view-state";
import { words } from "../words/words";
import { additionOf, anotherLike, removalOf, scatterPatch } from "./stone-edits";
import { idsOf, MOST_STONES, stoneOf, stonesOf } from "./stones";

export interface StoneWorld {
  state: () => ViewState;
  send: (event: SessionEvent) => void;
  choose: (id: string | null) => void;
  /** What the user should know. */
  tell: (text: string) => void;
}

/** So many removals can be taken back. */
const REMEMBERED = 100;

export class StoneCommands {
  private readonly world: StoneWorld;
  private readonly removed: JsonObject[] = [];

  constructor(world: StoneWorld) {
    this.world = world;
  }

  /** How many stones can be put back. */
  get removals(): number {
    return this.away().length;
  }

  /** The stone that is chosen, or the only one; null if it is not known which. */
  chosen(): string | null {
    const { scene, stone } = this.world.state();
    const [only, ...others] = idsOf(scene);
    return stone ?? (others.length === 0 ? (only ?? null) : null);
  }

  choose(id: string | null): void {
    this.world.choose(id);
  }

  look(): void {
    this.toChosen("look_at_stone");
  }

  /** At the chosen stone, or at all. */
  lookAround(): void {
    const { scene, stone } = this.world.state();
    if (stonesOf(scene).length === 0) this.world.tell(words.stones.noStone);
    else this.world.send(stone === null ? { type: "look_at_stone" } : { type: "look_at_stone", stone });
  }

  reset(): void {
    this.toChosen("reset_stone");
  }

  /** Keep the stone where it is while time goes on for others, or let it go. */
  hold(): void {
    this.toChosen("toggle_fall");
  }

  add(): void {
    const { scene, stone } = this.world.state();
    if (this.hasRoom()) this.bring(anotherLike(scene, stone ?? undefined));
  }

  remove(): void {
    const { scene } = this.world.state();
    const id = this.chosen();
    if (id === null) {
      this.world.tell(stonesOf(scene).length > 0 ? words.stones.chooseFirst : words.stones.noStone);
      return;
    }
    this.removed.push(stoneOf(scene, id));
    if (this.removed.length > REMEMBERED) this.removed.shift();
    this.world.choose(null);
    this.patch(removalOf(id));
  }

  /** The stone that was removed last. */
  putBack(): void {
    const stone = this.away().at(-1);
    if (!stone) {
      this.world.tell(words.stones.nothingRemoved);
    } else if (this.hasRoom()) {
      this.removed.splice(this.removed.lastIndexOf(stone), 1);
      this.bring(additionOf(this.world.state().scene, stone));
    }
  }

  /** All stones into the air, from where they fall. */
  scatter(): void {
    const { scene, falling } = this.world.state();
    if (stonesOf(scene).length === 0) {
      this.world.tell(words.stones.noStone);
      return;
    }
    this.patch(scatterPatch(scene));
    if (!falling) this.world.send({ type: "toggle_fall" });
  }

  /** Another scene was opened: what was removed from the one before is not its. */
  forget(): void {
    this.removed.length = 0;
  }

  /** Those removed that did not come back otherwise, as by an undo. */
  private away(): JsonObject[] {
    const there = new Set(stonesOf(this.world.state().scene).map((stone) => JSON.stringify(stone)));
    return this.removed.filter((stone) => !there.has(JSON.stringify(stone)));
  }

  private hasRoom(): boolean {
    const room = stonesOf(this.world.state().scene).length < MOST_STONES;
    if (!room) this.world.tell(words.stones.noRoom(MOST_STONES));
    return room;
  }

  private toChosen(type: "look_at_stone" | "reset_stone" | "toggle_fall"): void {
    const { stone } = this.world.state();
    if (stone === null) this.world.tell(words.stones.chooseFirst);
    else this.world.send({ type, stone });
  }

  private bring({ id, patch }: { id: string; patch: JsonObject }): void {
    this.patch(patch);
    this.world.choose(id);
  }

  private patch(patch: JsonObject): void {
    this.world.send({ type: "patch_scene", patch });
  }
}
