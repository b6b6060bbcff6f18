import { expect, test } from "vitest";
import type { Path, Step } from "../session/answers";
import { factsOf, happensText, lightText, percent, sentencesOf, span } from "./ray-text";

const PASS = {
  start: [0, 0, 0],
  point: [0, 0, 0],
  direction: [0, 0, -1],
  weight_before: 0.5,
  weight: 0.4,
  kept: 0.25,
  cut: 0,
  light: [0, 0, 0],
  length: 0.5,
  incidence_degrees: 20,
  refraction_degrees: 56,
  critical_degrees: 24.4,
  reflectance: { s: 0.4, p: 0.1, unpolarised: 0.25 },
} as const;

function meeting(changed: object): Step {
  const passes = [0, 1].map((chain) => ({ ...PASS, chain, ...changed }));
  return { number: 3, parent: 2, kind: "meets", stone: "gem", facet: 7, facet_name: "main", passes } as unknown as Step;
}

const POSE = { position: [0, 0, 0], orientation: [1, 0, 0, 0], scale: 1 };
const PATH = {
  chains: [{ channel: "red" }, { channel: "green" }, { channel: "blue" }],
  poses: { gem: POSE },
  parts: [
    { meets: "lamp", number: 4, side: "left", share: 0.72, light: [1, 1, 1] },
    { meets: "sky", number: null, side: null, share: 0.2796, light: [1, 1, 1] },
    { meets: "floor", number: null, side: null, share: 0.0004, light: [0, 0, 0] },
  ],
} as unknown as Path;

test("where a pixel's light comes from is said from the brightest on, without what nobody sees", () => {
  expect(sentencesOf(PATH)).toEqual([
    "72\u00a0% of this pixel comes from the lamp at the left (emitter 4)",
    "28\u00a0% of this pixel comes from the sky",
  ]);
  expect(sentencesOf({ ...PATH, parts: [] })).toEqual(["No light comes by this ray."]);
});

test("a facet is named, with its stone where there are several", () => {
  expect(happensText(meeting({}), PATH)).toBe("leaves by main, 25\u00a0% reflected");
  expect(happensText(meeting({ refraction_degrees: null, kept: 1 }), PATH)).toBe("totally reflected at main");
  const two = { ...PATH, poses: { gem: POSE, other: POSE } } as unknown as Path;
  expect(happensText(meeting({}), two)).toBe("leaves by main of gem, 25\u00a0% reflected");
});

test("light from outside is told by what it comes from, of several the brightest", () => {
  const seen = { ...meeting({}), kind: "sees" } as unknown as Step;
  expect(happensText({ ...seen, parts: PATH.parts }, PATH)).toBe("comes from the lamp at the left (emitter 4)");
  expect(happensText({ ...seen, parts: PATH.parts.slice(1) }, PATH)).toBe("comes from the sky");
  expect(happensText(seen, PATH)).toBe("comes from outside");
});

test("the channels that go together are told by their letters, wavelengths by their span", () => {
  expect(lightText(meeting({}), PATH)).toBe("RG");
  const waves = { ...PATH, chains: [{ wavelength: 450 }, { wavelength: 650 }] } as unknown as Path;
  expect(lightText(meeting({}), waves)).toBe("450\u2013650 nm");
  expect(lightText(meeting({ chain: null }), PATH)).toBe("all");
});

test("lengths are in millimetres, and weights what goes each way", () => {
  const facts = Object.fromEntries(factsOf(meeting({}), PATH, 3.25));
  expect(facts["Way in the stone"]).toBe("1.63 mm");
  expect(facts["After absorption"]).toBe("40\u00a0%");
  expect(facts["Weight that is reflected"]).toBe("10\u00a0%");
  expect(facts["Weight that goes through"]).toBe("30\u00a0%");
  expect(facts["Critical angle"]).toBe("24.40\u00b0");
});

test("numbers keep the digits that are worth telling", () => {
  expect([0.5, 0.0123, 0.0004, 0, -0.2].map(percent)).toEqual([
    "50\u00a0%",
    "1.2\u00a0%",
    "0.04\u00a0%",
    "0\u00a0%",
    "-20\u00a0%",
  ]);
  expect(span([20.004, 20.001, null], 2)).toBe("20.00");
  expect(span([20, 21.5], 1)).toBe("20.0\u201321.5");
});
