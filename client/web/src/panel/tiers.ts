/** The tiers of a stone, as the server lists them, and the merge patches that change their angles. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part } from "../json";
import type { TierAngle } from "../session/answers";
import { stoneOf, stonePatch } from "../stones/stones";

export const SIDES = ["crown", "pavilion"] as const;
export type Side = (typeof SIDES)[number];

/** The field of a scene that the server names where it refuses an angle. */
const ANGLES = /^stones\.[^.]+\.recut\.angles\b/;

/** What the stone's tiers depend on; empty without a stone. */
export function shapeOf(scene: JsonObject | null): string {
  const { id, cut, mesh, recut } = stoneOf(scene);
  return id === undefined ? "" : JSON.stringify([id, cut, mesh ?? null, recut ?? null]);
}

/** The degrees that the scene asks for, by tiers' numbers. */
export function anglesOf(scene: JsonObject | null): Record<string, number> {
  const angles = part(part(stoneOf(scene), "recut"), "angles");
  return Object.fromEntries(Object.entries(angles).map(([tier, degrees]) => [tier, number(degrees, Number.NaN)]));
}

/** What a tier's reach depends on: everything but its own angle. */
export function othersOf(scene: JsonObject | null, tier: string): string {
  const { id, cut, mesh, recut } = stoneOf(scene);
  const { [tier]: _, ...angles } = anglesOf(scene);
  const { angles: __, ...ratios } = (recut ?? {}) as JsonObject;
  return JSON.stringify([tier, id, cut, mesh ?? null, ratios, angles]);
}

/** The merge patch that turns one tier and leaves the angles of the others that are asked for. */
export function tierPatch(scene: JsonObject | null, tier: string, degrees: number): JsonObject {
  return stonePatch(scene, { recut: { angles: { [tier]: degrees } } });
}

/** The merge patch that has the tiers of a list where they were before anybody turned them. */
export function asTheyWerePatch(scene: JsonObject | null, tiers: readonly TierAngle[]): JsonObject {
  return stonePatch(scene, { recut: { angles: Object.fromEntries(tiers.map(({ tier }) => [tier, null])) } });
}

/** Whether the refusal is of an angle. */
export function isOfAngles(field: string | undefined): boolean {
  return field !== undefined && ANGLES.test(field);
}

/** Tiers that can be turned for themselves, and those that follow them. */
export function parted(tiers: readonly TierAngle[], side: Side): { free: TierAngle[]; following: TierAngle[] } {
  const own = tiers.filter((tier) => tier.side === side);
  return { free: own.filter((tier) => tier.independent), following: own.filter((tier) => !tier.independent) };
}

/** The server's list for a stone; the ends of the tier `reach` are those at which its meets are kept. */
export type ListTiers = (scene: JsonObject, reach: string | null) => Promise<TierAngle[]>;

/** One answer for crown and pavilion, which ask for the same stone one after the other. */
export function sharing(list: ListTiers): ListTiers {
  let last: { of: string; answer: Promise<TierAngle[]> } | null = null;
  return (scene, reach) => {
    if (reach !== null) return list(scene, reach);
    const of = shapeOf(scene);
    if (last?.of !== of) {
      const answer = list(scene, null);
      last = { of, answer };
      answer.catch(() => {
        last = null; // the next one may have better luck
      });
    }
    return last.answer;
  };
}
