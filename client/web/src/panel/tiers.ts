/** The tiers of a stone, as the server lists them, and the merge patches that change their angles. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object, part, text } from "../json";
import type { TierAngle } from "../session/answers";
import { stoneOf, stonePatch } from "../stones/stones";

export const SIDES = ["crown", "pavilion"] as const;
export type Side = (typeof SIDES)[number];

/** The field of a scene that the server names where it refuses an angle. */
const ANGLES = /^stones\.[^.]+\.recut\.angles\b/;
/** Of `recut`, what leaves the stone as it is; null does of all else. */
const UNCHANGED: JsonObject = { crown_ratio: 1, pavilion_ratio: 1 };

/** What the stone's tiers depend on; empty without a stone. */
export function shapeOf(scene: JsonObject | null): string {
  const { id, cut, mesh, recut } = stoneOf(scene);
  return id === undefined ? "" : JSON.stringify([id, cut, mesh ?? null, recut ?? null]);
}

/** The stone and what is cut anew of it: other tiers than those of the same. */
export function bodyOf(scene: JsonObject | null): string {
  const { id, cut, mesh } = stoneOf(scene);
  return JSON.stringify([id, cut, mesh ?? null]);
}

/** The same but for the proportions of a cut, which seldom has other tiers with others. */
export function kindOf(scene: JsonObject | null): string {
  const { id, cut, mesh } = stoneOf(scene);
  return JSON.stringify([id, text(cut, text(object(cut).name, "")), mesh ?? null]);
}

/** The degrees that the scene asks for, by tiers' numbers. */
export function anglesOf(scene: JsonObject | null): Record<string, number> {
  const angles = part(part(stoneOf(scene), "recut"), "angles");
  return Object.fromEntries(Object.entries(angles).map(([tier, degrees]) => [tier, number(degrees, Number.NaN)]));
}

/** What a tier's reach depends on: everything but its own angle. */
export function othersOf(scene: JsonObject | null, tier: string): string {
  const { id, cut, mesh } = stoneOf(scene);
  const { [tier]: _, ...angles } = anglesOf(scene);
  return JSON.stringify([tier, id, cut, mesh ?? null, ratiosOf(scene), angles]);
}

/** What `recut` changes but angles. */
function ratiosOf(scene: JsonObject | null): [string, unknown][] {
  const { angles: _, ...others } = part(stoneOf(scene), "recut");
  return Object.entries(others).filter(([name, value]) => value !== null && value !== UNCHANGED[name]);
}

/** The merge patch that turns one tier and leaves the angles of the others that are asked for. */
export function tierPatch(scene: JsonObject | null, tier: string, degrees: number): JsonObject {
  return stonePatch(scene, { recut: { angles: { [tier]: degrees } } });
}

/** The merge patch that has those tiers where they were before anybody turned them. */
export function asTheyWerePatch(scene: JsonObject | null, tiers: readonly string[]): JsonObject {
  return stonePatch(scene, { recut: recutWithout(scene, tiers) });
}

/** What a merge patch says of `recut` to take the angles of those tiers away: null if nothing of it is left then. */
export function recutWithout(scene: JsonObject | null, tiers: readonly string[]): JsonObject | null {
  const left = Object.keys(anglesOf(scene)).filter((tier) => !tiers.includes(tier));
  const stays = left.length > 0 || ratiosOf(scene).length > 0;
  return stays ? { angles: Object.fromEntries(tiers.map((tier) => [tier, null])) } : null;
}

/** Those tiers of a list, by their numbers, whose angle the scene asks for. */
export function turned(scene: JsonObject | null, tiers: readonly TierAngle[]): string[] {
  const angles = anglesOf(scene);
  return tiers.map(({ tier }) => String(tier)).filter((tier) => tier in angles);
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
export type ListTiers = (scene: JsonObject, reach: string | null, signal?: AbortSignal) => Promise<TierAngle[]>;

/** One answer for crown and pavilion, which ask for the same stone one after the other. */
export function sharing(list: ListTiers): ListTiers {
  let last: { of: string; answer: Promise<TierAngle[]> } | null = null;
  return (scene, reach, signal) => {
    if (reach !== null) return list(scene, reach, signal);
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
