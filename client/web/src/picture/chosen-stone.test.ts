import { beforeEach, describe, expect, it } from "vitest";
import { ChosenStone } from "./chosen-stone";

let asked: object[];
let chosen: (string | null)[];
let outlines: (readonly number[] | null)[];
let stone: ChosenStone;
const TRIANGLE = [0, 0, 1, 0, 0, 1];

beforeEach(() => {
  [asked, chosen, outlines] = [[], [], []];
  stone = new ChosenStone({
    ask: (question) => asked.push(question),
    chosen: (id) => chosen.push(id),
    outline: (points) => outlines.push(points),
  });
});

describe("a click", () => {
  it("chooses the stone that the server finds there, or none", () => {
    stone.pick(0.5, -0.25);
    expect(asked).toEqual([{ type: "pick", number: 1, x: 0.5, y: -0.25 }]);
    stone.heard({ type: "picked", number: 1, stone: "ruby" });
    stone.pick(1, 1);
    stone.heard({ type: "picked", number: 2, stone: null });
    expect(chosen).toEqual(["ruby", null]);
  });

  it("tells whoever asked what was there, once, unless there was another", () => {
    const told: unknown[] = [];
    stone.pick(0, 0, (id) => told.push(["first", id]));
    stone.pick(1, 0, (id) => told.push(["second", id]));
    for (const number of [1, 2, 2]) stone.heard({ type: "picked", number, stone: "ruby" });
    expect(told).toEqual([["second", "ruby"]]);
  });

  it("counts no more after the next one", () => {
    stone.pick(0, 0);
    stone.pick(1, 0);
    stone.heard({ type: "picked", number: 1, stone: "ruby" });
    expect(stone.id).toBeNull();
  });
});

describe("the outline", () => {
  const outlined = (step: number, id = "ruby") => stone.heard({ type: "outlined", stone: id, step, points: TRIANGLE });

  it("is asked for once for each step that is shown", () => {
    stone.shown(7n, 0);
    expect(asked).toEqual([]);
    stone.choose("ruby");
    stone.shown(7n, 1);
    outlined(7);
    stone.shown(7n, 2);
    expect(asked).toEqual([{ type: "outline", stone: "ruby", step: 7 }]);
    expect(outlines).toEqual([null, TRIANGLE]);
  });

  it("is asked for one picture at a time, and then for the latest", () => {
    stone.choose("ruby");
    for (const step of [1n, 2n, 3n]) stone.shown(step, Number(step));
    outlined(1);
    expect(asked.map((question) => (question as { step: number }).step)).toEqual([1, 3]);
  });

  it("is asked for again where no answer came", () => {
    stone.choose("ruby");
    stone.shown(1n, 0);
    stone.shown(2n, 2000);
    expect(asked).toHaveLength(2);
  });

  it("of a stone that is chosen no more is not drawn", () => {
    stone.shown(1n, 0);
    stone.choose("ruby");
    stone.choose("glass");
    outlined(1);
    expect(outlines).toEqual([null, null]);
    outlined(1, "glass");
    expect(outlines.at(-1)).toEqual(TRIANGLE);
  });
});

it("waits for a stone that was just added", () => {
  stone.there(["glass"]);
  stone.choose("ruby");
  stone.there(["glass"]);
  expect(stone.id).toBe("ruby");
});

it("lets go of a stone that somebody has removed", () => {
  stone.choose("ruby");
  stone.there(["ruby", "glass"]);
  expect(stone.id).toBe("ruby");
  stone.there(["glass"]);
  expect(chosen).toEqual(["ruby", null]);
});
