/** A hand on the picture: takes the stone under the pointer, and moves or turns it until it lets go. */

import type { SessionEvent } from "../session/events";
import { turnBy } from "./gestures";
import { dragOf, movesOf } from "./moves";

export interface HandWorld {
  /** Ids of the stones that there are. */
  ids: () => readonly string[];
  /** Choose the stone at a place, css pixels of the canvas, and tell which it is; null: none. */
  pick: (x: number, y: number, told: (id: string | null) => void) => void;
  send: (event: SessionEvent) => void;
  /** Css pixels of the picture: its height, and its shorter side. */
  size: () => { height: number; side: number };
}

export class Hand {
  private readonly world: HandWorld;
  private stone: string | null = null;
  private waiting = false;
  private dx = 0;
  private dy = 0;
  private turns = false;

  constructor(world: HandWorld) {
    this.world = world;
  }

  /** A scene's only stone is taken wherever the pointer is. */
  take(x: number, y: number): void {
    this.letGo();
    const [only, ...others] = this.world.ids();
    if (only !== undefined && others.length === 0) {
      this.stone = only;
      return;
    }
    this.waiting = true;
    this.world.pick(x, y, (id) => this.took(id));
  }

  /** By css pixels; until it is known what was taken, they are summed up. */
  move(dx: number, dy: number, turns: boolean): void {
    if (turns !== this.turns) this.flush();
    this.turns = turns;
    this.dx += dx;
    this.dy += dy;
  }

  /** Send what was moved since: once an animation frame. */
  flush(): void {
    const { stone, dx, dy } = this;
    if (stone === null || (dx === 0 && dy === 0)) return;
    this.dx = this.dy = 0;
    const { height, side } = this.world.size();
    const events = this.turns
      ? movesOf(turnBy(dx, dy, side, "stone"), "stone", stone)
      : [dragOf(stone, dx, dy, height)];
    for (const event of events) this.world.send(event);
  }

  letGo(): void {
    this.flush();
    this.stone = null;
    this.waiting = false;
    this.dx = this.dy = 0;
  }

  private took(id: string | null): void {
    if (!this.waiting) return;
    this.waiting = false;
    this.stone = id;
    this.flush();
  }
}
