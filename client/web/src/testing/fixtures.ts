/** The protocol's golden messages, for tests. */

import { readFileSync } from "node:fs";
import type { JsonObject } from "@culet/protocol/messages";

function path(file: string): URL {
  return new URL(`../../../../protocol/fixtures/${file}`, import.meta.url);
}

export interface FrameCase {
  file: string;
  /** As JSON has them: null for NaN. */
  fields?: Record<string, number | string | null>;
  expected?: string;
  got?: string;
}

export interface Messages {
  control_events: JsonObject[];
  notices: JsonObject[];
  refused_control_events: Record<string, string>;
  refused_notices: Record<string, string>;
}

export function frameCases(): Record<string, FrameCase> {
  return JSON.parse(readFileSync(path("frames.json"), "utf8"));
}

export function messages(): Messages {
  return JSON.parse(readFileSync(path("messages.json"), "utf8"));
}

export function bytes(file: string): ArrayBuffer {
  return new Uint8Array(readFileSync(path(file))).buffer;
}
