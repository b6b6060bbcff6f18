import type { JsonObject } from "@culet/protocol/messages";
import { describe, expect, it, vi } from "vitest";
import type { TierAngle } from "../session/answers";
import { asTheyWerePatch, bodyOf, isOfAngles, kindOf, othersOf, parted, sharing, tierPatch, turned } from "./tiers";

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
    const patch = (recut: JsonObject, ...tiers: string[]) => asTheyWerePatch(scene(recut), tiers);
    const angles = { stones: { a: { recut: { angles: { 3: null } } } } };
    const usual = { crown_ratio: 1, pavilion_ratio: 1, girdle_percent: null, table_percent: null };
    expect(patch({ ...usual, angles: { 3: 41, 4: 30 } }, "3")).toEqual(angles);
    expect(patch({ ...usual, table_percent: 55, angles: { 3: 41 } }, "3")).toEqual(angles);
    expect(patch({ ...usual, crown_ratio: 1.1, angles: { 3: 41 } }, "3")).toEqual(angles);
    expect(patch({ ...usual, angles: { 3: 41, 4: 30 } }, "3", "4")).toEqual({ stones: { a: { recut: null } } });
  });

  it("are told by their numbers where the scene asks for an angle", () => {
    expect(turned(scene({ angles: { 3: 41, 5: 20 } }), [tier(3), tier(4)])).toEqual(["3"]);
    expect(turned(scene(null), [tier(3)])).toEqual([]);
  });

  it("are those of a stone with its cut or mesh", () => {
    const of = (more: JsonObject): JsonObject => ({ stones: [{ id: "a", cut: "oval", mesh: null, ...more }] });
    const longer = of({ cut: { name: "oval", length: 1.4 } });
    expect(bodyOf(of({ recut: { crown_ratio: 1.1 } }))).toBe(bodyOf(of({})));
    expect(bodyOf(longer)).not.toBe(bodyOf(of({})));
    expect(kindOf(longer)).toBe(kindOf(of({})));
    for (const other of [{ id: "b" }, { cut: "emerald" }, { mesh: "m" }])
      expect(kindOf(of(other))).not.toBe(kindOf(of({})));
  });

  it("reach as far as all others let them", () => {
    const at = (angles: JsonObject) => othersOf(scene({ crown_ratio: 1, angles }), "3");
    expect(at({ 3: 41 })).toBe(at({ 3: 42 }));
    expect(at({ 3: 41, 4: 30 })).not.toBe(at({ 3: 41 }));
    const first = scene({
      crown_ratio: 1,
      pavilion_ratio: 1,
      girdle_percent: null,
      table_percent: null,
      angles: { 3: 41 },
    });
    expect(othersOf(first, "3")).toBe(othersOf(scene(null), "3"));
    expect(othersOf(scene({ crown_ratio: 1.1 }), "3")).not.toBe(othersOf(scene(null), "3"));
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
    await shared(scene({ crown_ratio: 1.1 }), "7"); // whose reach nobody has asked for
    expect(list).toHaveBeenCalledTimes(4);
    expect(list).toHaveBeenLastCalledWith(scene({ crown_ratio: 1.1 }), "7", undefined);
  });
});
