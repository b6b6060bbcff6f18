/** Text messages from the gateway, checked where they enter. */

import { type JsonObject, NOTICE_FIELDS, type Notice } from "./messages";

/** Text that is not a notice; says what was expected and what came. */
export class NoticeError extends Error {
  override name = "NoticeError";
}

function kindOf(value: unknown): string {
  if (value === null) return "null";
  if (value === undefined) return "absent";
  return Array.isArray(value) ? "array" : typeof value;
}

function allows(allowed: readonly string[], value: unknown): boolean {
  const kind = kindOf(value);
  return (
    allowed.includes(kind) ||
    (kind === "string" && allowed.includes(value as string)) ||
    (Number.isInteger(value) && allowed.includes("integer"))
  );
}

/** The notice in a text message, or null for a type that this client does not know; throws NoticeError. */
export function parseNotice(text: string): Notice | null {
  let data: unknown;
  try {
    data = JSON.parse(text);
  } catch {
    throw new NoticeError(`expected JSON, got ${JSON.stringify(text.slice(0, 80))}`);
  }
  if (kindOf(data) !== "object") throw new NoticeError(`expected a JSON object, got ${kindOf(data)}`);
  const fields = data as JsonObject;
  if (typeof fields.type !== "string") throw new NoticeError(`type: expected string, got ${kindOf(fields.type)}`);
  if (!Object.hasOwn(NOTICE_FIELDS, fields.type)) return null;
  for (const [name, allowed] of Object.entries(NOTICE_FIELDS[fields.type as Notice["type"]])) {
    if (!allows(allowed, fields[name])) {
      const got = kindOf(fields[name]);
      throw new NoticeError(`${fields.type}.${name}: expected ${allowed.join(" or ")}, got ${got}`);
    }
  }
  return data as Notice;
}
