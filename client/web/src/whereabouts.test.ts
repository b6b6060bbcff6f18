import { describe, expect, it, test } from "vitest";
import { whereabouts, whereaboutsText } from "./whereabouts";

const CAMERA = { position: [0, 0, 10], target: [0, 0, 0], up: [0, 1, 0], fov_degrees: 90 };

function of(position: unknown, aspect = 2, camera: Record<string, unknown> = CAMERA) {
  return whereabouts({ stones: [{ position }], camera }, aspect);
}

describe("the stone", () => {
  // At a distance of 10 the picture of 90 degrees reaches up to 10, and a ball of radius 1 until its centre is at
  // 10 + sqrt 2; a picture twice as wide reaches to 20 + sqrt 5 at the side.
  test.each([
    [[0, 11.4, 0], null],
    [[0, 11.5, 0], "above"],
    [[0, -11.5, 0], "below"],
    [[22.2, 0, 0], null],
    [[22.3, 0, 0], "right"],
    [[-22.3, 0, 0], "left"],
    [[0, 0, 10.9], null],
    [[0, 0, 11.1], "behind"],
  ] as const)("at %j is %s", (position, where) => expect(of(position)).toBe(where));

  it("is seen less far at the side of an upright picture", () => {
    expect(of([8, 0, 0], 0.5)).toBe("right");
    expect(of([8, 0, 0], 1)).toBeNull();
  });

  it("is above the default picture at the drop slider's end", () => {
    const camera = { position: [0, 2.4, 4.6], target: [0, 0.1, 0], up: [0, 1, 0], fov_degrees: 40 };
    expect(of([0, 0.5, 0], 1.6, camera)).toBeNull();
    expect(of([0, 8, 0], 1.6, camera)).toBe("above");
  });

  it.each([null, {}, { stones: [] }, { stones: [{}], camera: CAMERA }])("is nowhere in %j", (scene) =>
    expect(whereabouts(scene, 1)).toBeNull(),
  );
});

it("is told with the key that helps", () => {
  expect(whereaboutsText(null)).toBeNull();
  expect(whereaboutsText("above")).toContain("P lets it fall");
  expect(whereaboutsText("left")).toContain("to the left of the picture. F puts");
});
