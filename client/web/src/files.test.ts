import { describe, expect, it } from "vitest";
import { meshPatch, parseScene } from "./files";

describe("a scene's file", () => {
  it("is a JSON object", () => {
    expect(parseScene('{"floor": {"kind": "matte"}}', "a.json")).toEqual({ floor: { kind: "matte" } });
  });

  it.each([
    ["{nope", "a.json is not JSON"],
    ["[]", "a.json: expected a scene (a JSON object), got a list"],
    ["null", "a.json: expected a scene (a JSON object), got null"],
    ["12", "a.json: expected a scene (a JSON object), got 12"],
  ])("%s is refused in words", (text, complaint) => {
    expect(() => parseScene(text, "a.json")).toThrow(complaint);
  });
});

describe("a mesh", () => {
  it("takes the cut's place and leaves the stone's material", () => {
    const scene = { stones: [{ cut: "brilliant", mesh: null, material: "classic", position: [0, 4, 0] }] };
    expect(meshPatch(scene, "m1")).toEqual({
      stones: [{ cut: "brilliant", mesh: "m1", material: "classic", position: [0, 4, 0] }],
    });
  });

  it("makes a stone where there was none", () => {
    expect(meshPatch({ stones: [] }, "m1")).toEqual({ stones: [{ mesh: "m1" }] });
    expect(meshPatch(null, "m1")).toEqual({ stones: [{ mesh: "m1" }] });
  });
});
