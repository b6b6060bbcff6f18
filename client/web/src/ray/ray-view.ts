/** A ray, drawn over the picture and told in a table. Loaded when it is first asked for. */

import "./ray.css";
import type { JsonObject } from "@culet/protocol/messages";
import { element } from "../page";
import type { Path } from "../session/answers";
import * as rest from "../session/rest";
import { carried } from "./carrying";
import { Projection } from "./projection";
import { RayCard } from "./ray-card";
import { RayDrawing } from "./ray-drawing";
import type { RayWorld } from "./ray-mode";

/** ms without a change of the scene before the ray is asked for again. */
const PATIENCE_MS = 250;

export class RayView {
  private readonly world: RayWorld;
  private readonly drawing: RayDrawing;
  private readonly card: RayCard;
  /** What had the focus when the mode was turned on. */
  private readonly before = document.activeElement;
  private path: Path | null = null;
  private chosen: number | null = null;
  /** As the picture on the screen has it. */
  private scene: JsonObject | null = null;
  private step: bigint | null = null;
  private asking = false;
  private giveUp = new AbortController();
  private waiting: ReturnType<typeof setTimeout> | undefined;

  constructor(world: RayWorld, close: () => void) {
    this.world = world;
    this.drawing = new RayDrawing(element("outline", SVGSVGElement));
    this.card = new RayCard(element("main", HTMLElement), {
      chosen: (step) => {
        this.chosen = step;
        this.draw();
      },
      close,
    });
  }

  /** Ask for the ray of the pixel there: right and up from the picture's centre, in halves of its height. */
  async ask(right: number, up: number): Promise<void> {
    const frame = this.world.visit.lastFrame;
    const { session } = this.world.visit;
    if (!frame || session === null) return;
    const { width, height } = frame;
    const pixel = {
      x: Math.floor(width / 2 + (right * height) / 2),
      y: Math.floor(height / 2 - (up * height) / 2),
      width,
      height,
    };
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= width || pixel.y >= height) return;
    await this.tell((signal) => rest.path(session, pixel, signal));
  }

  /** The scene has changed, but for its camera: ask for the same ray again, once it stays as it is. */
  changed(): void {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      const { path } = this;
      const { session } = this.world.visit;
      if (path && session !== null)
        this.world.complaints.attempt(() => this.tell((signal) => rest.pathAlong(session, path, signal)));
    }, PATIENCE_MS);
  }

  private async tell(asked: (signal: AbortSignal) => Promise<Path>): Promise<void> {
    clearTimeout(this.waiting);
    this.giveUp.abort();
    this.giveUp = new AbortController();
    const { signal } = this.giveUp;
    this.card.wait();
    this.takeFocus();
    try {
      const path = await asked(signal);
      if (signal.aborted) return;
      this.path = path;
      this.scene = this.scene ?? this.world.visit.scene;
      this.chosen = path.steps[0]?.number ?? null;
      this.card.show(path, this.millimetres());
      this.takeFocus();
      this.step = null;
      this.follow();
      this.draw();
    } catch (error) {
      if (signal.aborted) return;
      this.card.fail(error);
      throw error;
    }
  }

  /**
   * From the picture, whose keys would move what is being followed, or a button that turned the mode on; not from a
   * control that somebody uses.
   */
  private takeFocus(): void {
    const { activeElement } = document;
    const onPicture = activeElement === this.world.canvas || activeElement === document.body;
    const turnedOn = activeElement instanceof HTMLButtonElement && activeElement === this.before;
    if (onPicture || turnedOn || this.card.focused) this.card.focus();
  }

  /** Lie where the picture on the screen has stones and camera. */
  follow(): void {
    const { session, lastFrame } = this.world.visit;
    if (!this.path || !lastFrame || session === null || this.asking || lastFrame.step === this.step) return;
    const { step } = lastFrame;
    this.asking = true;
    rest
      .sceneShown(session, step)
      .then((scene) => {
        this.scene = scene;
        this.step = step;
      })
      .catch(() => {
        this.step = step; // it is kept no more, and the next picture's will be
      })
      .finally(() => {
        this.asking = false;
        this.draw();
        this.follow();
      });
  }

  close(): void {
    clearTimeout(this.waiting);
    this.giveUp.abort();
    this.path = null;
    this.drawing.remove();
    this.card.remove();
  }

  private millimetres(): number {
    const { millimetres } = this.world.visit.scene ?? {};
    return typeof millimetres === "number" ? millimetres : 1;
  }

  private draw(): void {
    const { path } = this;
    const { lastFrame, scene } = this.world.visit;
    if (!path || !lastFrame) return;
    const shown = this.scene ?? scene;
    const { width, height } = this.world.canvas;
    this.drawing.show(
      carried(path, shown),
      path.chains,
      new Projection(shown),
      lastFrame,
      { width, height },
      this.chosen,
    );
  }
}
