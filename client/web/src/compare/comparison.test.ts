import type { JsonObject } from "@culet/protocol/messages";
import { describe, expect, it } from "vitest";
import { Comparison } from "./comparison";

const stone = (more: JsonObject): JsonObject => ({
  id: "a",
  cut: "brilliant",
  mesh: null,
  recut: null,
  material: "diamond",
  position: [0, 0, 0],
  orientation: [1, 0, 0, 0],
  ...more,
});
const scene = (more: JsonObject = {}): JsonObject => ({ stones: [{ id: "b" }, stone(more)] });
const FLAT = { cut: { name: "brilliant", pavilion_degrees: 39 }, position: [0, 0.1, 0] };

describe("a comparison", () => {
  it("changes two designs over, each where it lay, and back", () => {
    const comparison = new Comparison();
    expect(comparison.keep(scene(), "a")).toBe(true);
    const first = comparison.change(scene({ ...FLAT, position: [0, 0, 0] }));
    expect(first).toEqual({
      stones: {
        a: {
          cut: "brilliant",
          mesh: null,
          recut: null,
          material: "diamond",
          position: [0, 0, 0],
          orientation: [1, 0, 0, 0],
        },
      },
    });
    expect(comparison.change(scene())).toMatchObject({ stones: { a: { cut: FLAT.cut } } });
  });

  it("takes away what only the design has that is shown, as the angle of a tier", () => {
    const recut = (crown_ratio: number, angles: JsonObject) => ({ crown_ratio, table_percent: null, angles });
    const [kept, shown] = [recut(1, { 3: 41, 5: 20 }), recut(1.1, { 4: 30, 5: 21 })];
    const comparison = new Comparison();
    comparison.keep(scene({ recut: kept, cut: { name: "oval", length: 1.2 } }), "a");
    const patch = comparison.change(scene({ recut: shown, cut: { name: "emerald", pavilion_steps: 2 } }));
    expect(patch).toMatchObject({
      stones: {
        a: { recut: { ...kept, angles: { 3: 41, 4: null, 5: 20 } }, cut: { name: "oval", pavilion_steps: null } },
      },
    });
    const back = comparison.change(scene({ recut: kept, material: { name: "own", ior: [1, 2] } }));
    expect(back).toMatchObject({ stones: { a: { recut: { ...shown, angles: { 3: null, 4: 30, 5: 21 } } } } });
    const whole = comparison.change(scene({ material: { name: "own", ior: [2] } }));
    expect(whole).toMatchObject({ stones: { a: { recut: kept, material: { ior: [1, 2] } } } });
  });

  it("leaves a stone where it was moved to", () => {
    const comparison = new Comparison();
    comparison.keep(scene(), "a");
    const patch = comparison.change(scene({ ...FLAT, position: [3, 0, 0] }));
    expect(patch).toEqual({ stones: { a: { cut: "brilliant", mesh: null, recut: null, material: "diamond" } } });
  });

  it("has the other design lie where it lay, or where its stone was moved or has fallen to", () => {
    const comparison = new Comparison();
    expect(comparison.beside(scene(), scene())).toBeNull();
    comparison.keep(scene(), "a");
    expect(comparison.beside(scene(), scene())).toBeNull();
    const now = scene({ cut: FLAT.cut });
    const { id, ...own } = stone({});
    expect(comparison.beside(now, now)).toEqual({ stone: id, design: own });
    comparison.keep(scene(FLAT), "a");
    const raised = scene({ position: FLAT.position });
    expect(comparison.beside(raised, raised)).toMatchObject({ stone: "a", design: FLAT });
    const fallen = scene({ position: [0, -0.5, 0] });
    expect(comparison.beside(fallen, raised)?.design).toMatchObject({ cut: FLAT.cut });
    expect(comparison.beside(fallen, raised)?.design).not.toHaveProperty("position");
  });

  it("tells how the stone would be otherwise, if it would be at all", () => {
    const comparison = new Comparison();
    expect(comparison.otherwise(scene())).toBeNull();
    comparison.keep(scene(), "a");
    expect(comparison.otherwise(scene())).toBeNull();
    expect(comparison.otherwise(scene(FLAT))).toMatchObject({ stones: [{ id: "a", cut: "brilliant" }] });
  });

  it("ends with its stone, and does not begin without one", () => {
    const comparison = new Comparison();
    expect(comparison.keep({ stones: [] }, null)).toBe(false);
    comparison.keep(scene(), "a");
    expect(comparison.change({ stones: [{ id: "b" }] })).toBeNull();
  });
});
