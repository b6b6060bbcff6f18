import { describe, expect, it, test } from "vitest";
import { Fingers, pinchBy, pushBy, turnBy, wheelBy } from "./gestures";

describe("fingers", () => {
  it("drag when there is one", () => {
    const fingers = new Fingers();
    fingers.down(1, 10, 20);
    expect(fingers.move(1, 15, 18)).toEqual({ dx: 5, dy: -2, spread: 1 });
    expect(fingers.move(1, 15, 19)).toEqual({ dx: 0, dy: 1, spread: 1 });
  });

  it("pinch when there are two, and do not drag", () => {
    const fingers = new Fingers();
    fingers.down(1, 0, 0);
    fingers.down(2, 100, 0);
    expect(fingers.move(2, 200, 0)).toEqual({ dx: 0, dy: 0, spread: 2 });
    fingers.up(1);
    expect(fingers.move(2, 210, 0)).toEqual({ dx: 10, dy: 0, spread: 1 });
  });

  it("are ignored before they come down, after they leave, and from the third on", () => {
    const fingers = new Fingers();
    expect(fingers.move(1, 5, 5)).toBeNull();
    for (const id of [1, 2, 3]) fingers.down(id, id, 0);
    expect(fingers.move(3, 9, 9)).toBeNull();
    fingers.up(1);
    expect(fingers.move(1, 0, 0)).toBeNull();
  });

  it("at the same point spread by no ratio", () => {
    const fingers = new Fingers();
    fingers.down(1, 50, 50);
    fingers.down(2, 50, 50);
    expect(fingers.move(2, 60, 50)?.spread).toBe(1); // 10 over 0
    expect(fingers.move(2, 50, 50)?.spread).toBe(1); // 0 over 10
  });
});

describe("a drag", () => {
  it("over the shorter side is half a turn against the finger", () => {
    expect(turnBy(400, 0, 400, "camera").yaw).toBeCloseTo(-Math.PI, 12);
  });

  it("downwards lifts the camera, so that the scene follows the finger", () => {
    expect(turnBy(0, 100, 400, "camera").pitch).toBeCloseTo(Math.PI / 4, 12);
  });

  it.each(["light_1", "stone"] as const)("moves a light and turns a stone with the finger: %s", (target) => {
    const { yaw, pitch } = turnBy(100, 100, 400, target);
    expect(yaw).toBeCloseTo(Math.PI / 4, 12);
    expect(pitch).toBeCloseTo(-Math.PI / 4, 12);
  });

  it("on a canvas without size stays finite", () => {
    expect(Number.isFinite(turnBy(1, 1, 0, "camera").yaw)).toBe(true);
  });
});

test("spreading two fingers comes nearer, and closing them goes back as far", () => {
  expect(pinchBy(2)).toBeGreaterThan(0);
  expect(pinchBy(2) + pinchBy(0.5)).toBeCloseTo(0, 12);
});

describe("the wheel", () => {
  it("moves half a radius a notch, away from the user to come nearer", () => {
    expect(wheelBy(-100, 0)).toBe(0.5);
    expect(wheelBy(100, 0)).toBe(-0.5);
  });

  it("may count in lines or pages", () => {
    expect(wheelBy(-3, 1)).toBeCloseTo(0.24, 12); // 3 lines of 16 px
    expect(wheelBy(-0.25, 2)).toBeCloseTo(1, 12); // 200 px
  });

  it("is limited in bursts", () => {
    expect(wheelBy(-1e5, 0)).toBe(2);
    expect(wheelBy(1e5, 0)).toBe(-2);
  });
});

const PICTURE = { x: 0, y: 0, width: 400, height: 200 };

describe("a push", () => {
  it("strikes where the picture is that does not fill the canvas", () => {
    const beside = { x: 50, y: 0, width: 100, height: 200 };
    expect(pushBy(100, 100, 0, 0, beside)).toMatchObject({ x: 0, y: 0 });
    expect(pushBy(150, 200, 0, 0, beside)).toMatchObject({ x: 0.5, y: -1 });
  });

  it("strikes where it began, in halves of the picture's height from its centre", () => {
    expect(pushBy(300, 100, 0, 0, PICTURE)).toMatchObject({ type: "push", x: 1, y: 0 });
    expect(pushBy(200, 0, 0, 0, PICTURE)).toMatchObject({ x: 0, y: 1 });
  });

  it("goes with the finger, right and up, as far as it went", () => {
    expect(pushBy(0, 0, 50, 0, PICTURE)).toMatchObject({ right: 3 });
    expect(pushBy(0, 0, 0, -50, PICTURE)).toMatchObject({ up: 3 });
  });

  it("is gentle, however far the finger went", () => {
    expect(pushBy(0, 0, -9000, 9000, PICTURE)).toMatchObject({ right: -10, up: -10 });
  });
});
