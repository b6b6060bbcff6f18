/** The canvas: as many device pixels as it covers, and the picture last shown. */

import { coveredAfter } from "./fade";
import {
  deviceLength,
  type Fit,
  letterbox,
  type PictureSize,
  pictureSize,
  placed,
  type Rectangle,
  SHARP,
} from "./picture-size";
import { Settling } from "./settling";

/** Device pixels. */
const SLACK = 3;

export class Screen {
  private readonly context: CanvasRenderingContext2D;
  private readonly canvas: HTMLCanvasElement;
  private readonly onResize: (size: PictureSize) => void;
  private picture: ImageBitmap | null = null;
  /** What pictures are asked for: quick ones, and sharp ones once those are finished. */
  private quick: PictureSize = { width: 0, height: 0 };
  private sharp: PictureSize = { width: 0, height: 0 };
  private asked: PictureSize;
  /** What the canvas showed when the picture that comes up began to, and when, ms of the page's clock. */
  private fade: { under: HTMLCanvasElement; since: number } | null = null;
  private next = 0;
  private fit: Fit = "whole";
  private readonly settling = new Settling(() => this.settle());
  /** Told when pictures of another shape are shown otherwise from now on. */
  refitted: (fit: Fit) => void = () => undefined;

  constructor(canvas: HTMLCanvasElement, onResize: (size: PictureSize) => void) {
    this.canvas = canvas;
    this.onResize = onResize;
    const context = canvas.getContext("2d", { alpha: false });
    if (!context) throw new Error("expected a 2D canvas, got none from this browser");
    this.context = context;
    this.asked = this.quick = this.sharp = { width: canvas.width, height: canvas.height };
    const observer = new ResizeObserver(([entry]) => entry && this.resize(devicePixels(entry)));
    try {
      observer.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      observer.observe(canvas); // Safari before 18 knows no device pixels here
    }
  }

  /** Of the pictures that are asked for. */
  get size(): PictureSize {
    return this.asked;
  }

  /** From now on pictures of another shape are shown so. */
  fill(fit: Fit): void {
    this.fit = fit;
    this.refitted(this.fits);
    this.draw();
  }

  /** How it is with pictures of another shape. */
  get fits(): Fit {
    return this.settling.on ? "filled" : this.fit;
  }

  /** Whether the picture has another shape than the canvas. */
  get differs(): boolean {
    if (!this.picture) return false;
    const { x, y } = letterbox(this.picture, this.canvas);
    return x > SLACK || y > SLACK;
  }

  /** The quick picture is finished: on a screen of more pixels than full HD has, ask for one that has them too. */
  sharpen(): void {
    this.ask(this.sharp);
  }

  /** What is seen changes: many pixels would take too long. */
  hurry(): void {
    this.ask(this.quick);
  }

  /** Where the picture is on the canvas, css pixels: another viewer's picture may have another shape. */
  get area(): Rectangle {
    const { x, y, width, height } = this.place(this.picture ?? this.canvas);
    const css = this.canvas.clientWidth / this.canvas.width;
    return { x: x * css, y: y * css, width: width * css, height: height * css };
  }

  /** Whether the picture shown last is still coming up. */
  get fading(): boolean {
    return this.fade !== null;
  }

  /**
   * Takes over the bitmap and closes it when the next one comes. One that `refines` what is seen, and lies where that
   * lies, comes up over it; a hidden page has no frames in which it could.
   */
  show(picture: ImageBitmap, refines = false): void {
    const comesUp = refines && !document.hidden && this.covers(picture);
    this.picture?.close();
    this.picture = picture;
    const under = comesUp ? copyOf(this.canvas) : null;
    const larger = picture.width > this.quick.width || picture.height > this.quick.height;
    this.become(larger ? this.sharp : this.quick);
    if (this.settling.on) {
      this.settling.shown(!this.differs);
      if (!this.settling.on) this.refitted(this.fit);
    }
    if (!under) {
      this.draw();
      return;
    }
    cancelAnimationFrame(this.next);
    this.fade = { under, since: performance.now() };
    this.next = requestAnimationFrame((time) => this.comeUp(time));
  }

  /** Whether it lies where the last one lies, but for the pixel by which rounded sizes differ. */
  private covers(picture: ImageBitmap): boolean {
    if (!this.picture) return false;
    const before = this.place(this.picture);
    const after = this.place(picture);
    return Math.abs(before.width - after.width) <= SLACK && Math.abs(before.height - after.height) <= SLACK;
  }

  private comeUp(time: number): void {
    if (!this.fade) return;
    const covered = coveredAfter(time - this.fade.since);
    if (covered === 1) {
      this.draw();
      return;
    }
    this.context.globalAlpha = 1;
    this.context.drawImage(this.fade.under, 0, 0, this.canvas.width, this.canvas.height);
    this.paint(covered);
    this.next = requestAnimationFrame((later) => this.comeUp(later));
  }

  private resize(pixels: PictureSize): void {
    const before = [this.quick, this.sharp];
    this.quick = pictureSize(pixels.width, pixels.height);
    this.sharp = pictureSize(pixels.width, pixels.height, SHARP);
    if ([this.quick, this.sharp].every((size, kind) => isSame(size, before[kind] as PictureSize))) return;
    const fitted = this.picture !== null && !this.differs;
    this.become(this.quick);
    this.settling.resized(fitted && this.differs);
    if (this.settling.on) this.refitted(this.fits);
    this.draw(); // a canvas forgets its picture when its size changes
    this.ask(this.quick);
  }

  private become({ width, height }: PictureSize): void {
    if (!isSame({ width, height }, this.canvas)) Object.assign(this.canvas, { width, height });
  }

  private ask(size: PictureSize): void {
    if (isSame(size, this.asked)) return;
    this.asked = size;
    this.onResize(size);
  }

  private place(picture: PictureSize): Rectangle {
    return placed(picture, this.canvas, this.fits);
  }

  private settle(): void {
    this.refitted(this.fit);
    this.draw();
  }

  /** All of it, at once. */
  private draw(): void {
    this.fade = null;
    cancelAnimationFrame(this.next);
    if (!this.picture) return;
    const { x, y } = this.place(this.picture);
    if (x > 0 || y > 0) this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.paint(1);
  }

  private paint(alpha: number): void {
    if (!this.picture) return;
    const { x, y, width, height } = this.place(this.picture);
    this.context.globalAlpha = alpha;
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(this.picture, x, y, width, height);
  }
}

/** When what was drawn just now has been painted, ms of the page's clock. */
export function afterPainting(told: (time: number) => void): void {
  requestAnimationFrame(() => setTimeout(() => told(performance.now())));
}

function isSame(a: PictureSize, b: PictureSize): boolean {
  return a.width === b.width && a.height === b.height;
}

function copyOf(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  copy.getContext("2d", { alpha: false })?.drawImage(canvas, 0, 0);
  return copy;
}

function devicePixels(entry: ResizeObserverEntry): PictureSize {
  const exact = entry.devicePixelContentBoxSize?.[0];
  const { width, height } = entry.contentRect;
  return {
    width: deviceLength(width, devicePixelRatio, exact?.inlineSize),
    height: deviceLength(height, devicePixelRatio, exact?.blockSize),
  };
}
