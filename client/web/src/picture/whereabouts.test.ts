import { Flag } from "@culet/protocol/frame";
import { describe, expect, it, test } from "vitest";
import { GRACE_MS, Whereabouts, whereaboutsText } from "./whereabouts";

const ONE = { stones: [{}] };
const SEVERAL = { stones: [{}, {}, {}] };
const AT_REST = { simulationTime: 2, flags: Flag.FINAL };

test.each([
  [0, null],
  [Flag.ABOVE, "The stone is above the picture."],
  [Flag.BELOW | Flag.LEFT, "The stone is below the picture."],
  [Flag.LEFT, "The stone is to the left of the picture."],
  [Flag.RIGHT, "The stone is to the right of the picture."],
  [Flag.BEHIND, "The stone is behind the camera."],
] as const)("flags %i of a picture at rest say %j", (side, text) =>
  expect(whereaboutsText({ ...AT_REST, flags: AT_REST.flags | side }, ONE)).toBe(text),
);

it("is told with the key that helps before it falls, and only then", () => {
  expect(whereaboutsText({ simulationTime: 0, flags: Flag.ABOVE }, ONE)).toContain("P lets it fall");
  expect(whereaboutsText({ simulationTime: 0, flags: Flag.ABOVE | Flag.MOVING }, ONE)).not.toContain("P ");
  expect(whereaboutsText({ simulationTime: 0, flags: Flag.LEFT }, ONE)).not.toContain("P ");
});

it("is the nearest of several, and all of them fall", () => {
  const flags = Flag.ABOVE;
  expect(whereaboutsText({ simulationTime: 0, flags }, SEVERAL)).toBe(
    "The nearest stone is above the picture. P lets them fall.",
  );
});

describe("a stone that leaves the picture", () => {
  const gone = { simulationTime: 2, flags: Flag.MOVING | Flag.RIGHT };
  const seen = { ...gone, flags: Flag.MOVING };

  it("is looked for after a while if it moves", () => {
    const whereabouts = new Whereabouts();
    expect(whereabouts.after(seen, 5000, ONE)).toBeNull();
    expect(whereabouts.after(gone, 5000 + GRACE_MS - 1, ONE)).toBeNull();
    expect(whereabouts.after(gone, 5000 + GRACE_MS, ONE)).toContain("to the right");
    expect(whereabouts.after(seen, 5001 + GRACE_MS, ONE)).toBeNull();
    expect(whereabouts.after(gone, 5002 + GRACE_MS, ONE)).toBeNull();
  });

  it("is looked for at once if it lies still", () => {
    const whereabouts = new Whereabouts();
    whereabouts.after(seen, 5000, ONE);
    expect(whereabouts.after({ ...AT_REST, flags: Flag.RIGHT }, 5001, ONE)).toContain("to the right");
  });

  it("is looked for at once by a page that never saw it", () =>
    expect(new Whereabouts().after(gone, 5000, ONE)).toContain("to the right"));
});
