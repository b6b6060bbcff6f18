/** Parts of JSON from outside, of which nothing is known: what has another form counts as absent. */

import type { JsonObject } from "@culet/protocol/messages";

export function part(json: JsonObject | null, name: string): JsonObject {
  return object(json?.[name]);
}

export function object(value: unknown): JsonObject {
  return typeof value === "object" && value !== null ? (value as JsonObject) : {};
}

/** Whether it has members, which a list has not. */
export function isObject(value: unknown): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function list(value: unknown): JsonObject[] {
  return Array.isArray(value) ? value.map(object) : [];
}

export function text(value: unknown, otherwise: string): string {
  return typeof value === "string" ? value : otherwise;
}

export function number(value: unknown, otherwise: number): number {
  return typeof value === "number" ? value : otherwise;
}

export function triple(value: unknown): readonly [number, number, number] | null {
  const numbers = Array.isArray(value) ? value.filter((one) => typeof one === "number") : [];
  return numbers.length === 3 ? (numbers as [number, number, number]) : null;
}
