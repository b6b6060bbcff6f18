/** `window.culet`: what end-to-end tests, and the curious, may read. */

import type { Frame } from "@culet/protocol/frame";
import type { Target } from "./events";
import type { Connection } from "./stream";
import type { ViewState } from "./view-state";

/** The header of a frame; the step as a number, so that it goes to JSON. */
export type FrameHeader = Omit<Frame, "payload" | "step"> & { step: number };

export interface Probe {
  readonly session: string | null;
  readonly lastFrame: FrameHeader | null;
  readonly framesShown: number;
  /** The last frame is still coming up over the one before. */
  readonly fading: boolean;
  readonly outOfOrder: number;
  readonly state: ViewState;
  readonly target: Target;
  readonly connection: Connection["status"];
  readonly roundTripMs: number | null;
  readonly problems: readonly string[];
}

declare global {
  interface Window {
    readonly culet: Probe;
  }
}

export function header({ payload: _, step, ...rest }: Frame): FrameHeader {
  return { ...rest, step: Number(step) };
}

export function expose(probe: Probe): void {
  Object.defineProperty(window, "culet", { value: Object.freeze(probe), enumerable: true });
}
