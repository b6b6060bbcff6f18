/** The status line: what the last frame took and missed, told twice a second. */

import type { Visit } from "../session/visit";
import { words } from "../words/words";
import { briefText, statusText } from "./status-text";

const TOLD_MS = 500;

export function showStatus(line: HTMLElement, visit: Visit): void {
  const { meaning, errorAsShown, frontiersError } = words.status;
  line.title = `${meaning(errorAsShown, words.errors.shown)}\n${meaning(frontiersError, words.errors.frontier)}`;
  const [brief, all] = [document.createElement("span"), document.createElement("span")];
  brief.className = "brief"; // while the meter is folded
  all.className = "all";
  brief.textContent = words.page.connecting;
  line.replaceChildren(brief, all);
  setInterval(() => {
    const now = performance.now();
    const status = {
      connected: visit.viewer === null || visit.viewer.stream.connection.status === "open",
      framesPerSecond: visit.viewer?.rate.perSecond(now) ?? 0,
      frame: visit.lastFrame,
      roundTripMs: visit.viewer?.stream.latency.milliseconds ?? null,
      viewers: visit.state.viewers,
      bottleneck: visit.viewer?.bottleneck.at(now) ?? null,
    };
    brief.textContent = briefText(status);
    all.textContent = statusText(status);
  }, TOLD_MS);
}
