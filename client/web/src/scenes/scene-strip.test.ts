import { describe, expect, it } from "vitest";
import type { Preset } from "../session/catalogue";
import { byGroup, entryAfter } from "./scene-strip";

const preset = (name: string, group: Preset["group"]): Preset => ({
  name,
  group,
  title: name,
  summary: "",
  thumbnail: "",
  scene: {},
});

describe("arrow keys on the strip of scenes", () => {
  it("reach every entry from the first, and stop at the ends", () => {
    const reached = [0];
    for (let step = 0; step < 5; step++) reached.push(entryAfter("ArrowRight", reached.at(-1) ?? 0, 4) ?? -1);
    expect(reached).toEqual([0, 1, 2, 3, 3, 3]);
    expect(entryAfter("ArrowLeft", 0, 4)).toBe(0);
    expect(entryAfter("ArrowDown", 1, 4)).toBe(2);
    expect(entryAfter("ArrowUp", 1, 4)).toBe(0);
  });

  it("have Home and End beside them, and no other key", () => {
    expect(entryAfter("Home", 3, 4)).toBe(0);
    expect(entryAfter("End", 0, 4)).toBe(3);
    expect(entryAfter("Enter", 0, 4)).toBeNull();
    expect(entryAfter("p", 0, 4)).toBeNull();
  });
});

it("presets of a group stand together in the order that the server gives", () => {
  const groups = byGroup([preset("a", "diamonds"), preset("b", "instruments"), preset("c", "diamonds")]);
  expect([...groups].map(([name, members]) => [name, members.map((each) => each.name)])).toEqual([
    ["diamonds", ["a", "c"]],
    ["instruments", ["b"]],
  ]);
});
