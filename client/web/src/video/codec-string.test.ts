import { expect, it } from "vitest";
import { codecString } from "./codec-string";
import { TRIAL_FRAMES } from "./trial-frames";

const bytesOf = (text: string) => Uint8Array.from(atob(text), (byte) => byte.charCodeAt(0));

it("H.264's profile and level are those of the key frame's parameter set", () => {
  expect(codecString("h264", bytesOf(TRIAL_FRAMES.h264))).toBe("avc1.F4000A"); // High 4:4:4 Predictive, level 1
});

it("bytes without a parameter set are no key frame", () => {
  expect(codecString("h264", Uint8Array.of(0, 0, 0, 1, 0x41, 0x9a, 0x26, 0x21))).toBeNull();
});

it("VP9 is of the profile that has 4:4:4", () => {
  expect(codecString("vp9", new Uint8Array())).toMatch(/^vp09\.01\./);
});
