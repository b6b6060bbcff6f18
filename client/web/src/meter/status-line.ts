/** The status line: what the last frame took and missed, told twice a second. */

import type { Visit } from "../session/visit";
import { words } from "../words/words";
import { statusText } from "./status-text";

const TOLD_MS = 500;

export function showStatus(line: HTMLElement, visit: Visit): void {
  const { meaning, errorAsShown, frontiersError } = words.status;
  line.title = `${meaning(errorAsShown, words.errors.shown)}\n${meaning(frontiersError, words.errors.frontier)}`;
  setInterval(() => {
    const now = performance.now();
    line.textContent = statusText({
      framesPerSecond: visit.viewer?.rate.perSecond(now) ?? 0,
      frame: visit.lastFrame,
      roundTripMs: visit.viewer?.stream.latency.milliseconds ?? null,
      viewers: visit.state.viewers,
      bottleneck: visit.viewer?.bottleneck.at(now) ?? null,
    });
  }, TOLD_MS);
}
