import { describe, expect, it } from "vitest";
import { parseScene } from "./files";

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
