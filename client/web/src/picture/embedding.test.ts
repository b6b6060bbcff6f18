import { beforeEach, describe, expect, it } from "vitest";
import { embeddingOf, queryOf, REST_MS, Turntable } from "./embedding";

describe("an address", () => {
  it("that says nothing has the whole interface and stands still", () => {
    expect(embeddingOf("?preset=ruby")).toEqual({ ui: true, rotate: 0, legend: true, background: null });
    expect(queryOf(embeddingOf("?preset=ruby"))).toBe("");
  });

  it("asks for no interface and for a turntable, also in the address of the session that was made", () => {
    const asked = embeddingOf("?ui=0&rotate=-20.5&preset=ruby");
    expect(asked).toEqual({ ui: false, rotate: -20.5, legend: false, background: null });
    expect(embeddingOf(`?session=0${queryOf(asked)}`)).toEqual(asked);
  });

  it.each(["?ui=0&legend=1", "?legend=0"])("%s has a legend or none apart from the interface", (search) => {
    const asked = embeddingOf(search);
    expect(asked.legend).toBe(!asked.ui);
    expect(embeddingOf(`?session=0${queryOf(asked)}`)).toEqual(asked);
  });

  it("asks for a colour behind everything with or without its #, which the session then has", () => {
    for (const search of ["?background=f4f1ea", "?background=%23f4f1ea"]) {
      const asked = embeddingOf(search);
      expect(asked.background).toBe("#f4f1ea");
      expect(queryOf(asked)).toBe("");
    }
  });

  it.each([
    "?ui=no",
    "?ui=",
    "?rotate=fast",
    "?rotate=",
    "?rotate=361",
    "?rotate=NaN",
    "?rotate=Infinity",
    "?legend=yes",
    "?background=blue",
    "?background=transparent",
    "?background=",
  ])("%s is refused in words", (search) => {
    expect(() => embeddingOf(search)).toThrow(/in the address: expected .*, got/);
  });
});

describe("a turntable", () => {
  let yaws: number[];
  let table: Turntable;
  let shown: number;
  /** With a picture that was not there before. */
  const turn = (now: number) => {
    shown += 1;
    table.turn(now, shown);
  };

  beforeEach(() => {
    yaws = [];
    shown = 0;
    table = new Turntable(90, ({ yaw }) => yaws.push(yaw));
  });

  it("turns by its rate, however often pictures come", () => {
    for (const now of [1000, 1010, 1050, 1100, 1200]) turn(now);
    expect(yaws).toHaveLength(4);
    expect(yaws.reduce((sum, yaw) => sum + yaw, 0)).toBeCloseTo((0.2 * Math.PI) / 2, 12);
  });

  it("waits for the picture of the last turn, but not for ever", () => {
    turn(1000);
    turn(1050);
    table.turn(1060, shown);
    expect(yaws).toHaveLength(1);
    table.turn(1150, shown);
    expect(yaws).toHaveLength(2);
  });

  it("does not jump after a pause, as of a page that was hidden", () => {
    turn(1000);
    turn(61_000);
    expect(yaws[0]).toBeCloseTo((0.25 * Math.PI) / 2, 12);
  });

  it("leaves the view to who turns it by hand, and goes on after a while", () => {
    turn(1000);
    table.rest(1010);
    turn(1020);
    turn(1010 + REST_MS - 1);
    expect(yaws).toEqual([]);
    turn(1010 + REST_MS);
    turn(1010 + REST_MS + 100);
    expect(yaws).toHaveLength(1);
    expect(yaws[0]).toBeCloseTo((0.1 * Math.PI) / 2, 12);
  });

  it("is stopped and started", () => {
    turn(1000);
    table.toggle();
    turn(1100);
    expect(yaws).toEqual([]);
    table.toggle();
    turn(5000);
    turn(5100);
    expect(yaws).toHaveLength(1);
  });

  it("of rate 0 never turns", () => {
    const still = new Turntable(0, () => expect.unreachable());
    for (const now of [0, 100, 200]) still.turn(now, now);
  });
});
