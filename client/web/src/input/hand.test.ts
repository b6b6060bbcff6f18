import { beforeEach, describe, expect, it } from "vitest";
import type { SessionEvent } from "../session/events";
import { Hand } from "./hand";

let ids: string[];
let sent: SessionEvent[];
let asked: { x: number; y: number; told: (id: string | null) => void }[];
let hand: Hand;

beforeEach(() => {
  [sent, asked] = [[], []];
  ids = ["ruby", "glass"];
  hand = new Hand({
    ids: () => ids,
    pick: (x, y, told) => asked.push({ x, y, told }),
    send: (event) => sent.push(event),
    size: () => ({ height: 200, side: 100 }),
  });
});

describe("a hand", () => {
  it("moves what it took, and sends what was moved before that was known", () => {
    hand.take(30, 40);
    expect(asked).toMatchObject([{ x: 30, y: 40 }]);
    hand.move(10, 0, false);
    hand.flush();
    hand.move(10, -5, false);
    expect(sent).toEqual([]);
    asked[0]?.told("glass");
    expect(sent).toEqual([{ type: "drag_stone", stone: "glass", right: 0.2, up: 0.05 }]);
    hand.move(5, 0, false);
    hand.letGo();
    expect(sent).toHaveLength(2);
    hand.move(5, 0, false);
    hand.flush();
    expect(sent).toHaveLength(2);
  });

  it("takes a scene's only stone wherever it is, and no stone where none is", () => {
    ids = ["ruby"];
    hand.take(0, 0);
    hand.move(1, 0, false);
    hand.flush();
    expect(asked).toEqual([]);
    expect(sent).toMatchObject([{ stone: "ruby" }]);
    ids = ["ruby", "glass"];
    hand.take(0, 0);
    asked[0]?.told(null);
    hand.move(1, 0, false);
    hand.flush();
    expect(sent).toHaveLength(1);
  });

  it("with Shift turns the stone, after what it was moved by before", () => {
    ids = ["ruby"];
    hand.take(0, 0);
    hand.move(10, 0, false);
    hand.move(50, 0, true);
    hand.flush();
    expect(sent).toMatchObject([{ type: "drag_stone", right: 0.1 }, { type: "turn_stone" }]);
    expect((sent[1] as { yaw: number }).yaw).toBeCloseTo(Math.PI / 2, 12);
  });

  it("that let go before it knew what it had took nothing", () => {
    hand.take(0, 0);
    hand.move(10, 0, false);
    hand.letGo();
    asked[0]?.told("ruby");
    hand.flush();
    expect(sent).toEqual([]);
  });
});
