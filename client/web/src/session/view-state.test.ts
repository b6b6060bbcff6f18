import type { Notice } from "@culet/protocol/messages";
import { describe, expect, it, test } from "vitest";
import { describeChange, INITIAL, inVain, isAmiss, withNotice } from "./view-state";

function shown(scene: Record<string, unknown>, falling = false): Notice {
  return { type: "state", revision: 1, scene, falling };
}

const DEFAULT = { floor: { kind: "mirror" }, walls: { kind: "none" }, environment: { kind: "dark" } };

describe("the state after a notice", () => {
  it("shows what the scene says", () => {
    expect(withNotice(INITIAL, shown(DEFAULT, true))).toMatchObject({
      scene: DEFAULT,
      falling: true,
      mirror: true,
      light: false,
      walls: false,
    });
    const other = { floor: { kind: "matte" }, walls: { kind: "matte" }, environment: { kind: "light" } };
    expect(withNotice(INITIAL, shown(other))).toMatchObject({ mirror: false, light: true, walls: true });
  });

  it("knows that the stone sleeps, which older servers do not say", () => {
    const asleep = { type: "state", revision: 1, scene: DEFAULT, falling: true, asleep: true } as const;
    expect(withNotice(INITIAL, asleep).asleep).toBe(true);
    expect(withNotice(INITIAL, shown(DEFAULT, true)).asleep).toBe(false);
  });

  it("has the session's balance, half way if none is said", () => {
    const balance = { exactness: 0.75, pinned: true };
    expect(
      withNotice(INITIAL, { type: "state", revision: 1, scene: DEFAULT, falling: false, ...balance }),
    ).toMatchObject(balance);
    expect(withNotice(INITIAL, shown(DEFAULT))).toMatchObject({ exactness: 0.5, pinned: false });
  });

  it("knows whether there is something to undo and to redo, which older servers do not say", () => {
    const told = {
      type: "state",
      revision: 1,
      scene: DEFAULT,
      falling: false,
      can_undo: true,
      can_redo: true,
    } as const;
    expect(withNotice(INITIAL, told)).toMatchObject({ canUndo: true, canRedo: true });
    expect(withNotice(withNotice(INITIAL, told), shown(DEFAULT))).toMatchObject({ canUndo: false, canRedo: false });
  });

  it("follows by what has changed", () => {
    const before = withNotice(INITIAL, shown(DEFAULT));
    const parts = { floor: { kind: "matte" }, environment: { kind: "light" } };
    const change = { type: "change", revision: 5, since: 1, parts, falling: true } as const;
    expect(isAmiss(before, change)).toBe(false);
    expect(withNotice(before, change)).toMatchObject({
      revision: 5,
      scene: { ...DEFAULT, ...parts },
      falling: true,
      mirror: false,
      light: true,
    });
    expect(isAmiss(before, { ...change, since: 2 })).toBe(true);
    expect(isAmiss(INITIAL, change)).toBe(true);
    expect(isAmiss(INITIAL, shown(DEFAULT))).toBe(false);
  });

  it("survives a scene without the parts it looks at", () => {
    expect(withNotice(INITIAL, shown({ floor: null }))).toMatchObject({ mirror: false, light: false, walls: false });
  });

  it("keeps the target, which is this page's own affair", () => {
    expect(withNotice({ ...INITIAL, target: "light_2" }, shown(DEFAULT)).target).toBe("light_2");
  });

  it("knows that the server is about to be stopped, until another one says hello", () => {
    const leaving = withNotice(INITIAL, { type: "leaving", seconds: 600 });
    expect(leaving.leaving).toBe(600);
    const hello = { type: "hello", protocol: 2, session: "0", watch: "cd", viewer: 1 } as const;
    expect(withNotice(leaving, hello).leaving).toBeNull();
  });

  it("knows whether the engine lives; a new stream has one until told otherwise", () => {
    const down = withNotice(INITIAL, { type: "engine", status: "down" });
    expect(down.engine).toBe("down");
    expect(withNotice(down, { type: "engine", status: "up" }).engine).toBe("up");
    expect(withNotice(down, { type: "hello", protocol: 2, session: "0", watch: "cd", viewer: 1 }).engine).toBe("up");
  });

  it("is the same value if nothing in it changed", () => {
    expect(withNotice(INITIAL, { type: "pong", time: 1 })).toBe(INITIAL);
  });
});

describe("a change in words", () => {
  const before = withNotice(INITIAL, shown(DEFAULT));

  it("names every switch", () => {
    const after = { ...before, falling: true, mirror: false, light: true, walls: true, target: "light_1" } as const;
    expect(describeChange(before, after)).toBe(
      "moving the red light, the stone falls, checker, light sky, walls shown",
    );
  });

  it("tells a stone at rest from one that is paused", () => {
    const asleep = { ...before, falling: true, asleep: true };
    expect(describeChange({ ...asleep, asleep: false }, asleep)).toBe("the stone is at rest");
    expect(describeChange(asleep, { ...asleep, falling: false, asleep: false })).toBe("the stone is paused");
    expect(describeChange(asleep, { ...asleep, asleep: false })).toBe("the stone falls");
  });

  it("speaks of all stones where there are several", () => {
    const trio = { ...before, scene: { stones: [{}, {}, {}] } };
    expect(describeChange(trio, { ...trio, falling: true })).toBe("the stones fall");
    expect(describeChange(before, trio)).toBe("");
  });

  it("says nothing of the first scene, or of a camera that moved", () => {
    expect(describeChange(INITIAL, before)).toBe("");
    expect(describeChange(before, { ...before, scene: {} })).toBe("");
  });

  it("counts viewers in grammar", () => {
    expect(describeChange(before, { ...before, viewers: 2 })).toBe("2 viewers");
    expect(describeChange({ ...before, viewers: 2 }, before)).toBe("1 viewer");
  });
});

test("an undo or redo is in vain if there is nothing for it, and nothing else is", () => {
  const can = { ...INITIAL, canUndo: true, canRedo: true };
  for (const type of ["undo", "redo"] as const) {
    expect(inVain(can, { type })).toBeNull();
    expect(inVain(INITIAL, { type })).toMatch(`nothing to ${type}`);
  }
  expect(inVain({ ...can, canRedo: false }, { type: "undo" })).toBeNull();
  expect(inVain(INITIAL, { type: "toggle_fall" })).toBeNull();
});
