/** When the hand last did something. */

/** Events of input, before any handler of the page sees them. */
const INPUTS = ["keydown", "pointerdown", "pointermove", "pointerup", "wheel"] as const;
/** What is sent later than so many ms after an input was not its doing. */
const RECENT_MS = 100;

let last = Number.NEGATIVE_INFINITY;
for (const name of INPUTS) {
  window.addEventListener(
    name,
    ({ timeStamp }) => {
      last = timeStamp;
    },
    { capture: true, passive: true },
  );
}

/** Of the input that what is sent now comes from, ms of the page's clock; now, if it comes from none. */
export function inputTime(): number {
  const now = performance.now();
  return now - last < RECENT_MS ? last : now;
}
