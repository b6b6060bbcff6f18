/** The canvas: as many device pixels as it covers, and the picture last shown. */

import { coveredAfter } from "./fade";
import { deviceLength, letterbox, pictureSize, type Rectangle, type Size } from "./picture-size";

/** Device pixels. */
const SLACK = 3;

export class Screen {
  private readonly context: CanvasRenderingContext2D;
  private readonly canvas: HTMLCanvasElement;
  private readonly onResize: (size: Size) => void;
  private picture: ImageBitmap | null = null;
  /** What the canvas showed when the picture that comes up began to, and when, ms of the page's clock. */
  private fade: { under: HTMLCanvasElement; since: number } | null = null;
  private next = 0;

  constructor(canvas: HTMLCanvasElement, onResize: (size: Size) => void) {
    this.canvas = canvas;
    this.onResize = onResize;
    const context = canvas.getContext("2d", { alpha: false });
    if (!context) throw new Error("expected a 2D canvas, got none from this browser");
    this.context = context;
    const observer = new ResizeObserver(([entry]) => entry && this.resize(devicePixels(entry)));
    try {
      observer.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      observer.observe(canvas); // Safari before 18 knows no device pixels here
    }
  }

  get size(): Size {
    return { width: this.canvas.width, height: this.canvas.height };
  }

  /** Where the picture is on the canvas, css pixels: another viewer's picture may have another shape. */
  get area(): Rectangle {
    const { x, y, width, height } = letterbox(this.picture ?? this.size, this.size);
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
    if (!comesUp) {
      this.draw();
      return;
    }
    cancelAnimationFrame(this.next);
    this.fade = { under: copyOf(this.canvas), since: performance.now() };
    this.next = requestAnimationFrame((time) => this.comeUp(time));
  }

  /** Whether it lies where the last one lies, but for the pixel by which rounded sizes differ. */
  private covers(picture: ImageBitmap): boolean {
    if (!this.picture) return false;
    const before = letterbox(this.picture, this.canvas);
    const after = letterbox(picture, this.canvas);
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
    this.context.drawImage(this.fade.under, 0, 0);
    this.paint(covered);
    this.next = requestAnimationFrame((later) => this.comeUp(later));
  }

  private resize(pixels: Size): void {
    const size = pictureSize(pixels.width, pixels.height);
    if (size.width === this.canvas.width && size.height === this.canvas.height) return;
    Object.assign(this.canvas, size);
    this.draw(); // a canvas forgets its picture when its size changes
    this.onResize(size);
  }

  /** All of it, at once. */
  private draw(): void {
    this.fade = null;
    cancelAnimationFrame(this.next);
    if (!this.picture) return;
    const { x, y } = letterbox(this.picture, this.canvas);
    if (x > 0 || y > 0) this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.paint(1);
  }

  private paint(alpha: number): void {
    if (!this.picture) return;
    const { x, y, width, height } = letterbox(this.picture, this.canvas);
    this.context.globalAlpha = alpha;
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(this.picture, x, y, width, height);
  }
}

/** When what was drawn just now has been painted, ms of the page's clock. */
export function afterPainting(told: (time: number) => void): void {
  requestAnimationFrame(() => setTimeout(() => told(performance.now())));
}

function copyOf(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  copy.getContext("2d", { alpha: false })?.drawImage(canvas, 0, 0);
  return copy;
}

function devicePixels(entry: ResizeObserverEntry): Size {
  const exact = entry.devicePixelContentBoxSize?.[0];
  const { width, height } = entry.contentRect;
  return {
    width: deviceLength(width, devicePixelRatio, exact?.inlineSize),
    height: deviceLength(height, devicePixelRatio, exact?.blockSize),
  };
}
