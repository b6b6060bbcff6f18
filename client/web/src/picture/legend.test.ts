import { describe, expect, it } from "vitest";
import { headOf, instrumentOf, legendOf } from "./legend";

const camera = { kind: "orthographic", position: [0, 12, 0], target: [0, 0, 0], up: [0, 0, -1] };
const under = (image: string, more = {}) => ({ camera, environment: { kind: "image", image, ...more } });

describe("the legend", () => {
  it("tells an instrument's colours by the head that the scene has", () => {
    const lines = legendOf(under("aset", { head_degrees: 20 }));
    expect(lines.map(({ colour }) => colour)).toEqual(["red", "green", "blue", "black", undefined]);
    expect(lines[0]?.text).toContain("70\u00b0");
    expect(headOf(under("ideal-scope", { head_degrees: null }))).toBe(10);
  });

  it("tells the tilt and its side wherever rays are parallel", () => {
    const tilted = { camera: { ...camera, position: [6, 6, 0] }, environment: { kind: "studio" } };
    expect(legendOf(tilted)).toHaveLength(1);
    expect(legendOf(tilted)[0]?.text).toContain("45.0\u00b0");
    expect(legendOf(tilted)[0]?.text).toContain("90\u00b0");
  });

  it("has nothing to say of another scene", () => {
    expect(legendOf({ camera: { ...camera, kind: "pinhole" }, environment: { kind: "studio" } })).toEqual([]);
    expect(instrumentOf(under("light-box"))).toBe("");
  });
});
