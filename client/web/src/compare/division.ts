/** The mode that shows two designs with a divider between them: what draws it is loaded when it is first turned on. */

import type { Visit } from "../session/visit";
import type { Complaints } from "../signs/complaints";
import type { Comparison } from "./comparison";
import type { DividedView } from "./divided-view";

export interface DivisionWorld {
  visit: Visit;
  canvas: HTMLCanvasElement;
  comparison: Comparison;
  complaints: Complaints;
}

export class Division {
  private readonly world: DivisionWorld;
  private view: DividedView | null = null;
  private wanted = false;

  constructor(world: DivisionWorld) {
    this.world = world;
  }

  async toggle(): Promise<void> {
    this.wanted = !this.wanted;
    this.view?.close();
    this.view = null;
    if (!this.wanted) return;
    try {
      const { DividedView } = await import("./divided-view");
      if (this.wanted && !this.view) this.view = new DividedView(this.world);
    } catch (error) {
      this.wanted = false;
      throw error;
    }
  }

  get on(): boolean {
    return this.wanted;
  }

  /** Another picture is on the screen. */
  shown(): void {
    this.view?.shown();
  }

  /** Another design is kept. */
  kept(): void {
    this.view?.changed();
  }
}
