import type { JsonObject } from "@culet/protocol/messages";
import { describe, expect, it, vi } from "vitest";
import type { TierAngle } from "../session/answers";
import { asTheyWerePatch, isOfAngles, othersOf, parted, sharing, tierPatch } from "./tiers";

const scene = (recut: JsonObject | null): JsonObject => ({
  stones: [{ id: "a", cut: "brilliant", mesh: null, recut }],
});
const tier = (number: number, more: Partial<TierAngle> = {}): TierAngle => ({
  tier: number,
  names: ["main"],
  facets: 8,
  side: "pavilion",
  degrees: 41,
  independent: true,
  least: 21,
  most: 61,
  ...more,
});

describe("tiers of a stone", () => {
  it("are turned one by one, and back", () => {
    expect(tierPatch(scene(null), "3", 41.2)).toEqual({ stones: { a: { recut: { angles: { 3: 41.2 } } } } });
    expect(asTheyWerePatch(scene(null), [tier(3), tier(4)])).toEqual({
      stones: { a: { recut: { angles: { 3: null, 4: null } } } },
    });
  });

  it("reach as far as all others let them", () => {
    const at = (angles: JsonObject) => othersOf(scene({ crown_ratio: 1, angles }), "3");
    expect(at({ 3: 41 })).toBe(at({ 3: 42 }));
    expect(at({ 3: 41, 4: 30 })).not.toBe(at({ 3: 41 }));
  });

  it("are refused by their field", () => {
    expect(isOfAngles("stones.a.recut.angles")).toBe(true);
    expect(isOfAngles("stones.a.recut.crown_ratio")).toBe(false);
    expect(isOfAngles(undefined)).toBe(false);
  });

  it("are free, or follow", () => {
    const tiers = [tier(1, { side: "crown" }), tier(2), tier(3, { independent: false })];
    expect(parted(tiers, "pavilion")).toEqual({ free: [tiers[1]], following: [tiers[2]] });
  });

  it("are asked for once for crown and pavilion, and again after a failure", async () => {
    const list = vi.fn(async (_: JsonObject, reach: string | null) => {
      if (list.mock.calls.length === 1) throw new Error("busy");
      return [tier(Number(reach ?? 1))];
    });
    const shared = sharing(list);
    await expect(shared(scene(null), null)).rejects.toThrow("busy");
    expect(await shared(scene(null), null)).toEqual(await shared(scene(null), null));
    expect(list).toHaveBeenCalledTimes(2);
    await shared(scene({ crown_ratio: 1.1 }), null);
    await shared(scene(null), "7");
    expect(list).toHaveBeenCalledTimes(4);
  });
});
