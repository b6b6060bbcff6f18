import { beforeEach, describe, expect, it } from "vitest";
import { type Fit, placed } from "./picture-size";
import { WindowFit } from "./window-fit";

const LYING = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };

describe("a picture in a window of another shape", () => {
  it("is seen as a whole, or fills the window from edge to edge", () => {
    expect(placed(LYING, PHONE, "whole")).toEqual({ x: 0, y: 312, width: 390, height: 219 });
    expect(placed(LYING, PHONE, "filled")).toEqual({ x: -555, y: 0, width: 1500, height: 844 });
    expect(placed({ width: 720, height: 1280 }, { width: 800, height: 400 }, "filled")).toMatchObject({
      x: 0,
      width: 800,
    });
  });

  it("is the same either way if it has the window's shape", () => {
    expect(placed(LYING, LYING, "filled")).toEqual(placed(LYING, LYING, "whole"));
  });
});

describe("the choice", () => {
  let button: HTMLButtonElement;
  let applied: Fit[];
  let kept: Map<string, string>;
  const memory = () => ({
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => void kept.set(key, value),
  });

  beforeEach(() => {
    button = { hidden: true, textContent: "", onclick: null } as unknown as HTMLButtonElement;
    applied = [];
    kept = new Map();
  });

  it("begins with the whole picture, is changed by the button, and is kept", () => {
    new WindowFit(button, (fit) => applied.push(fit), memory);
    expect(button.textContent).toContain("Fill the window");
    button.onclick?.(new Event("click") as PointerEvent);
    expect(button.textContent).toContain("Show all");
    new WindowFit(button, (fit) => applied.push(fit), memory).toggle();
    expect(applied).toEqual(["whole", "filled", "filled", "whole"]);
  });

  it("is offered while the shapes differ", () => {
    const fit = new WindowFit(button, () => undefined, memory);
    fit.offer(true);
    expect(button.hidden).toBe(false);
    fit.offer(false);
    expect(button.hidden).toBe(true);
  });

  it("can be made where the browser forbids to remember", () => {
    const fit = new WindowFit(
      button,
      (how) => applied.push(how),
      () => {
        throw new DOMException("denied", "SecurityError");
      },
    );
    fit.toggle();
    expect(applied).toEqual(["whole", "filled"]);
  });
});
