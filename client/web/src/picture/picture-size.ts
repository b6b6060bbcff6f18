/** How many pixels to ask for, and where a picture goes on the canvas. */

export interface PictureSize {
  width: number;
  height: number;
}

/** The largest picture of its kind, either way round. */
export interface Largest {
  long: number;
  short: number;
}

/** Of pictures that move, or come first: a full HD screen. */
export const QUICK: Largest = { long: 1920, short: 1080 };
/** Of pictures at rest: a 4K screen. */
export const SHARP: Largest = { long: 3840, short: 2160 };
/** The protocol's smallest. */
const SMALLEST = 16;

/**
 * Device pixels of a length in css pixels. The browser's exact value says how it rounded; it is not believed further than
 * that, since Chromium gives css pixels when it emulates another screen.
 */
export function deviceLength(css: number, ratio: number, exact?: number): number {
  const pixels = css * ratio;
  return exact !== undefined && Math.abs(exact - pixels) <= 1 ? exact : Math.round(pixels);
}

/** A size of device pixels within the limits, with the same aspect. */
export function pictureSize(width: number, height: number, largest = QUICK): PictureSize {
  const long = Math.max(width, height, 1);
  const short = Math.max(Math.min(width, height), 1);
  const scale = Math.min(1, largest.long / long, largest.short / short);
  const pixels = (side: number) => Math.max(SMALLEST, Math.round(side * scale));
  return { width: pixels(width), height: pixels(height) };
}

export interface Rectangle extends PictureSize {
  x: number;
  y: number;
}

/** All of a picture is seen, or it fills the canvas and what does not fit is cut off. */
export type Fit = "whole" | "filled";

/** The largest centred rectangle of the picture's aspect that fits the canvas. */
export function letterbox(picture: PictureSize, canvas: PictureSize): Rectangle {
  return placed(picture, canvas, "whole");
}

/** That rectangle, or the smallest one that covers the canvas. */
export function placed(picture: PictureSize, canvas: PictureSize, fit: Fit): Rectangle {
  const across = [canvas.width / picture.width, canvas.height / picture.height];
  const scale = fit === "whole" ? Math.min(...across) : Math.max(...across);
  const width = Math.round(picture.width * scale);
  const height = Math.round(picture.height * scale);
  return { x: Math.floor((canvas.width - width) / 2), y: Math.floor((canvas.height - height) / 2), width, height };
}

/** The largest size of the picture's shape of which the canvas shows all: beyond it nobody sees a pixel more. */
export function sizeWithin(picture: PictureSize, canvas: PictureSize): PictureSize {
  const { width, height } = letterbox(picture, canvas);
  return { width: Math.max(1, width), height: Math.max(1, height) };
}
