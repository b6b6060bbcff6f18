/** The mode in which a click draws a ray: what draws it is loaded when the mode is first turned on. */

import type { JsonObject } from "@culet/protocol/messages";
import type { Visit } from "../session/visit";
import type { Complaints } from "../signs/complaints";
import type { RayView } from "./ray-view";

export interface RayWorld {
  visit: Visit;
  canvas: HTMLCanvasElement;
  complaints: Complaints;
  /** The mode is on, or not any more. */
  changed: (on: boolean) => void;
}

/** The middle of the picture: where a ray is drawn before anybody has clicked. */
const MIDDLE = { x: 0, y: 0 };

export class RayMode {
  private readonly world: RayWorld;
  private view: RayView | null = null;
  private wanted = false;

  constructor(world: RayWorld) {
    this.world = world;
  }

  get on(): boolean {
    return this.wanted;
  }

  async toggle(): Promise<void> {
    this.wanted = !this.wanted;
    this.world.changed(this.wanted);
    if (!this.wanted) {
      this.view?.close();
      this.view = null;
      return;
    }
    const { RayView } = await import("./ray-view");
    if (!this.wanted || this.view) return;
    this.view = new RayView(this.world, () => this.wanted && void this.toggle());
    this.ask(MIDDLE);
  }

  /** A click: right and up from the picture's centre, in halves of its height. */
  ask(place: { x: number; y: number }): void {
    const { view } = this;
    if (view) this.world.complaints.attempt(() => view.ask(place.x, place.y));
  }

  /** The session's scene is another one. What is seen of it changes a ray's way only if more than the camera moved. */
  changed(before: JsonObject | null, after: JsonObject | null): void {
    const differs = (name: string) => name !== "camera" && before?.[name] !== after?.[name];
    if (before && after && Object.keys({ ...before, ...after }).some(differs)) this.view?.changed();
  }

  /** Another picture is on the screen. */
  shown(): void {
    this.view?.follow();
  }
}
