import { describe, expect, it } from "vitest";
import { deviceLength, letterbox, pictureSize, SHARP, sizeWithin } from "./picture-size";

describe("the size asked for", () => {
  it("is the device's pixels up to full HD, either way round", () => {
    expect(pictureSize(1280, 720)).toEqual({ width: 1280, height: 720 });
    expect(pictureSize(1080, 1920)).toEqual({ width: 1080, height: 1920 });
  });

  it("is capped with its aspect kept", () => {
    expect(pictureSize(3840, 2160)).toEqual({ width: 1920, height: 1080 });
    expect(pictureSize(2400, 2400)).toEqual({ width: 1080, height: 1080 });
    expect(pictureSize(1125, 2436)).toEqual({ width: 887, height: 1920 });
  });

  it("at rest is the device's pixels up to 4K", () => {
    expect(pictureSize(3840, 2160, SHARP)).toEqual({ width: 3840, height: 2160 });
    expect(pictureSize(2880, 1800, SHARP)).toEqual({ width: 2880, height: 1800 });
    expect(pictureSize(5120, 2880, SHARP)).toEqual({ width: 3840, height: 2160 });
  });

  it("is never less than the protocol allows", () => {
    expect(pictureSize(0, 0)).toEqual({ width: 16, height: 16 });
    expect(pictureSize(8000, 4)).toEqual({ width: 1920, height: 16 });
  });
});

describe("device pixels", () => {
  it("are as exact as the browser says", () => {
    expect(deviceLength(333.5, 1.5, 501)).toBe(501);
    expect(deviceLength(333.5, 1.5)).toBe(500);
  });

  it("are computed when the browser gives css pixels instead", () => {
    expect(deviceLength(375, 2, 375)).toBe(750);
  });
});

describe("the letterbox", () => {
  it("fills the canvas with a picture of its aspect", () => {
    expect(letterbox({ width: 640, height: 360 }, { width: 1280, height: 720 })).toEqual({
      x: 0,
      y: 0,
      width: 1280,
      height: 720,
    });
  });

  it("centres another one between bars", () => {
    expect(letterbox({ width: 100, height: 100 }, { width: 300, height: 200 })).toEqual({
      x: 50,
      y: 0,
      width: 200,
      height: 200,
    });
  });

  it("is all that is worth to be asked for beside a picture, even where that fills the window", () => {
    const tall = { width: 1080, height: 1920 };
    expect(sizeWithin(tall, { width: 2560, height: 1440 })).toEqual({ width: 810, height: 1440 });
    expect(sizeWithin(tall, { width: 300, height: 0 })).toEqual({ width: 1, height: 1 });
  });
});
