/** The canvas: as many device pixels as it covers, and the picture last shown. */

import { deviceLength, letterbox, pictureSize, type Rectangle, type Size } from "./picture-size";

export class Screen {
  private readonly context: CanvasRenderingContext2D;
  private readonly canvas: HTMLCanvasElement;
  private readonly onResize: (size: Size) => void;
  private picture: ImageBitmap | null = null;

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

  /** Takes over the bitmap and closes it when the next one comes. */
  show(picture: ImageBitmap): void {
    this.picture?.close();
    this.picture = picture;
    this.draw();
  }

  private resize(pixels: Size): void {
    const size = pictureSize(pixels.width, pixels.height);
    if (size.width === this.canvas.width && size.height === this.canvas.height) return;
    Object.assign(this.canvas, size);
    this.draw(); // a canvas forgets its picture when its size changes
    this.onResize(size);
  }

  private draw(): void {
    if (!this.picture) return;
    const { x, y, width, height } = letterbox(this.picture, this.canvas);
    if (x > 0 || y > 0) this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(this.picture, x, y, width, height);
  }
}

function devicePixels(entry: ResizeObserverEntry): Size {
  const exact = entry.devicePixelContentBoxSize?.[0];
  const { width, height } = entry.contentRect;
  return {
    width: deviceLength(width, devicePixelRatio, exact?.inlineSize),
    height: deviceLength(height, devicePixelRatio, exact?.blockSize),
  };
}
