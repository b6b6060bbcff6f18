/** `window.culet`: what end-to-end tests, and the curious, may read. */

import type { Frame } from "@culet/protocol/frame";
import type { Delay, Delays } from "./meter/delays";
import type { Screen } from "./picture/screen";
import type { Target } from "./session/events";
import type { Connection } from "./session/stream";
import type { ViewState } from "./session/view-state";
import type { Visit } from "./session/visit";

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
  /** From input to picture, of inputs since delays are watched: while the meter is open, or `watchDelays` was called. */
  readonly delays: readonly Delay[];
  readonly watchDelays: () => void;
}

declare global {
  interface Window {
    readonly culet: Probe;
  }
}

export function header({ payload: _, step, ...rest }: Frame): FrameHeader {
  return { ...rest, step: Number(step) };
}

function expose(probe: Probe): void {
  Object.defineProperty(window, "culet", { value: Object.freeze(probe), enumerable: true });
}

export function exposeVisit(visit: Visit, screen: Screen, delays: Delays, problems: readonly string[]): void {
  expose({
    get session() {
      return visit.session;
    },
    get lastFrame() {
      return visit.lastFrame ? header(visit.lastFrame) : null;
    },
    get fading() {
      return screen.fading;
    },
    get framesShown() {
      return visit.viewer?.player.shown ?? 0;
    },
    get outOfOrder() {
      return visit.viewer?.player.outOfOrder ?? 0;
    },
    get state() {
      return visit.state;
    },
    get target() {
      return visit.state.target;
    },
    get connection() {
      return visit.viewer?.stream.connection.status ?? "connecting";
    },
    get roundTripMs() {
      return visit.viewer?.stream.latency.milliseconds ?? null;
    },
    problems,
    delays: delays.kept,
    watchDelays: () => {
      delays.on = true;
    },
  });
}
