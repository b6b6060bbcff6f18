import { parseFrame } from "@culet/protocol/frame";
import { expect, test } from "vitest";
import { bytes } from "../testing/fixtures";
import { askedRate, balanceText, settingsText } from "./balance";

test.each([
  [0, 60],
  [0.5, 30],
  [1, 15],
])("an exactness of %d asks for %d frames a second", (exactness, rate) => {
  expect(askedRate({ exactness, pinned: false })).toBeCloseTo(rate);
  expect(balanceText({ exactness, pinned: false })).toContain(`${rate} frames/s`);
});

test("a pinned balance asks for no rate", () => {
  expect(askedRate({ exactness: 0.5, pinned: true })).toBeNull();
  expect(balanceText({ exactness: 0.5, pinned: true })).toContain("held at 50 %");
  expect(balanceText({ exactness: 1, pinned: true })).toContain("all that the scene asks for");
});

test("settings are read from the frame's header", () => {
  expect(settingsText(parseFrame(bytes("jpeg.bin")))).toBe(
    "16\u00d78 \u00b7 1 sample \u00b7 3 bands \u00b7 cut-off 0.0156 \u00b7 256 bounces \u00b7 unpolarised",
  );
  expect(settingsText(parseFrame(bytes("png.bin")))).toMatch(/1024 samples .* 64 bands .* polarised$/);
});
