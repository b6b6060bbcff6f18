/** The merge patches that add, remove and scatter stones. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, part, text, triple } from "../json";
import { stoneOf, stonesOf } from "./stones";

type Place = readonly [number, number, number];

/** R between the balls about two stones, at least. */
const GAP = 0.1;
/** R: height of the floor. */
const FLOOR = -1;
/** R above the floor, of the balls about scattered stones: so high they are when they begin to fall. */
const LEAST_FALL = 0.5;
const MOST_FALL = 2.5;
/** The room's walls: how far from the middle they are, R, and where they face, x and z. */
const WALLS = 8;
const WALLS_FACE = [
  [0, 1],
  [Math.sqrt(0.75), 0.5],
  [-Math.sqrt(0.75), 0.5],
] as const;
const LONGEST_ID = 32;
/** Places that are tried for a stone before it may be higher up by its radius, and as much farther off as it is from there. */
const TRIES = 200;

/** The merge patch that takes a stone away. */
export function removalOf(id: string): JsonObject {
  return { stones: { [id]: null } };
}

/** The merge patch that adds a stone; one that was removed comes back by its own id, unless that is taken by now. */
export function additionOf(scene: JsonObject | null, stone: JsonObject): { id: string; patch: JsonObject } {
  const id = freeId(idOf(stone) || "stone", stonesOf(scene).map(idOf));
  return { id, patch: { stones: { [id]: { ...stone, id } } } };
}

/** An id like that one: "ruby" or "ruby-2" lead to "ruby-3" if both are taken. */
export function freeId(like: string, taken: readonly string[]): string {
  if (!taken.includes(like)) return like;
  const stem = like.replace(/-\d+$/, "");
  for (let count = 2; ; count++) {
    const id = `${stem.slice(0, LONGEST_ID - `-${count}`.length)}-${count}`;
    if (!taken.includes(id)) return id;
  }
}

/** Another stone like that one, as near to it as there is room at its height. */
export function anotherLike(scene: JsonObject | null, id?: string): { id: string; patch: JsonObject } {
  const like = stoneOf(scene, id);
  const others = stonesOf(scene).map(ballOf);
  return additionOf(scene, { ...like, position: placeBeside(ballOf(like), others) });
}

function idOf(stone: JsonObject): string {
  return text(stone.id, "");
}

interface Ball {
  at: Place;
  radius: number;
}

function ballOf(stone: JsonObject): Ball {
  return { at: triple(stone.position) ?? [0, 0, 0], radius: number(stone.scale, 1) };
}

/** On rings about the ball, each a radius wider: to the right, to the left, behind, and in front of the ball last. */
function placeBeside(ball: Ball, others: readonly Ball[]): Place {
  const [x, y, z] = ball.at;
  for (let ring = 2 * ball.radius + GAP; ; ring += ball.radius) {
    for (const turn of [0, 4, 1, 3, 2, 7, 5, 6]) {
      const angle = (turn * Math.PI) / 4;
      const at: Place = [x + ring * Math.cos(angle), y, z - ring * Math.sin(angle)];
      if (isFree({ at, radius: ball.radius }, others)) return at;
    }
  }
}

function isFree(ball: Ball, others: readonly Ball[]): boolean {
  return others.every(({ at, radius }) => {
    const away = Math.hypot(at[0] - ball.at[0], at[1] - ball.at[1], at[2] - ball.at[2]);
    return away >= radius + ball.radius + GAP * 0.99;
  });
}

/**
 * The merge patch that has all stones in the air about what the camera looks at, at random places and turned at random,
 * apart from each other and within the walls. The more they are, the wider they lie. `random` is a number from 0 to 1.
 */
export function scatterPatch(scene: JsonObject | null, random = Math.random): JsonObject {
  const placed: Ball[] = [];
  const [x, , z] = triple(part(scene, "camera").target) ?? [0, 0, 0];
  const inside = part(scene, "walls").kind === "none" ? () => true : isWithinWalls;
  const stones = stonesOf(scene).map((stone): [string, JsonObject] => {
    const { radius } = ballOf(stone);
    const at = freePlace(radius, [x, z], (ball) => inside(ball) && isFree(ball, placed), stonesOf(scene), random);
    placed.push({ at, radius });
    return [idOf(stone), { position: at, orientation: randomTurn(random) }];
  });
  return { stones: Object.fromEntries(stones) };
}

function isWithinWalls({ at, radius }: Ball): boolean {
  return WALLS_FACE.every(([x, z]) => x * at[0] + z * at[2] >= radius + GAP - WALLS);
}

function freePlace(
  radius: number,
  [x, z]: readonly [number, number],
  fits: (ball: Ball) => boolean,
  all: readonly JsonObject[],
  random: () => number,
): Place {
  const area = all.reduce((sum, stone) => sum + (ballOf(stone).radius + GAP) ** 2, 0);
  const widest = 1.2 * Math.sqrt(area);
  for (let tries = 0; ; tries++) {
    const reach = widest * (1 + tries / TRIES) * Math.sqrt(random());
    const angle = 2 * Math.PI * random();
    const height = FLOOR + radius + LEAST_FALL + (MOST_FALL - LEAST_FALL + (radius * tries) / TRIES) * random();
    const at: Place = [x + reach * Math.cos(angle), height, z + reach * Math.sin(angle)];
    if (fits({ at, radius })) return at;
  }
}

/** Of all rotations each as likely as any other (Shoemake 1992), as w, x, y, z. */
function randomTurn(random: () => number): readonly number[] {
  const [u, v, w] = [random(), 2 * Math.PI * random(), 2 * Math.PI * random()];
  const [a, b] = [Math.sqrt(1 - u), Math.sqrt(u)];
  return [a * Math.sin(v), a * Math.cos(v), b * Math.sin(w), b * Math.cos(w)];
}
