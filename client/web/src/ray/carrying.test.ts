import { expect, test } from "vitest";
import type { Pass, Path, Step } from "../session/answers";
import { carried } from "./carrying";

function pass(start: Pass["start"], point: Pass["point"]): Pass {
  return {
    start,
    point,
    chain: 0,
    direction: [0, -1, 0],
    weight_before: 1,
    weight: 1,
    kept: 0,
    cut: 0,
    light: [0, 0, 0],
  };
}

function step(number: number, parent: number | null, kind: Step["kind"], stone: string | null, own: Pass): Step {
  return { number, parent, kind, stone, passes: [own] };
}

const PATH: Path = {
  pixel: [0, 0, 1, 1],
  origin: [0, 5, 0],
  direction: [0, -1, 0],
  value: [0, 0, 0],
  cut: 0,
  chains: [],
  parts: [],
  left_out: 0,
  polarised: false,
  poses: { a: { position: [0, 0, 0], orientation: [1, 0, 0, 0], scale: 1 } },
  steps: [
    step(0, null, "enters", "a", pass([0, 5, 0], [0, 1, 0])),
    step(1, 0, "meets", "a", pass([0, 1, 0], [1, 0, 0])),
    step(2, 1, "sees", null, pass([1, 0, 0], [4, 0, 0])),
  ],
};

function stone(position: number[], orientation: number[]) {
  return { stones: [{ id: "a", position, orientation, scale: 1 }] };
}

test("lines lie where they were told while the stone does", () => {
  const lines = carried(PATH, stone([0, 0, 0], [1, 0, 0, 0]));
  expect(lines.map(({ to }) => to)).toEqual([
    [0, 1, 0],
    [1, 0, 0],
    [4, 0, 0],
  ]);
});

test("a stone that moves and turns takes its whole path along", () => {
  const half = Math.SQRT1_2; // a quarter turn about z: x goes to y
  const [, inside, out] = carried(PATH, stone([0, 0, 7], [half, 0, 0, half]));
  for (const [k, at] of [0, 1, 7].entries()) expect(inside?.to[k]).toBeCloseTo(at);
  for (const [k, at] of [0, 4, 7].entries()) expect(out?.to[k]).toBeCloseTo(at);
  expect(out?.from).toEqual(inside?.to);
});
