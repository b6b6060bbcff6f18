/** Pointer and wheel events of the canvas, summed up and sent once an animation frame. */

import type { SessionEvent, Target } from "./events";
import { Fingers, orbitBy, pinchBy, pushBy, wheelBy } from "./gestures";
import type { Rectangle } from "./picture-size";

/** Css pixels: by so little a finger moves that only taps. */
const STILL = 6;

export function listenToPointers(
  canvas: HTMLCanvasElement,
  targetNow: () => Target,
  send: (event: SessionEvent) => void,
  /** A click or tap, css pixels from the canvas' upper left corner. */
  click: (x: number, y: number) => void,
  /** Where the picture is on the canvas, css pixels. */
  area: () => Rectangle,
): void {
  const fingers = new Fingers();
  let pending: { target: Target; yaw: number; pitch: number; forward: number } | null = null;

  /** A pointer that went down alone and has not been moved since. */
  let still: { id: number; x: number; y: number } | null = null;
  /** Where a push began, css pixels; it is given when the pointer goes up. */
  let push: { id: number; x: number; y: number } | null = null;

  function flush(): void {
    if (!pending) return;
    const { target, yaw, pitch, forward } = pending;
    pending = null;
    if (yaw !== 0 || pitch !== 0) send({ type: "orbit", target, yaw, pitch });
    if (forward !== 0) send({ type: "dolly", target, forward });
  }

  function add(yaw: number, pitch: number, forward: number): void {
    if (!pending) {
      pending = { target: targetNow(), yaw: 0, pitch: 0, forward: 0 };
      requestAnimationFrame(flush);
    }
    pending.yaw += yaw;
    pending.pitch += pitch;
    pending.forward += forward;
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    if (event.shiftKey) {
      push = { id: event.pointerId, x: event.offsetX, y: event.offsetY };
      return;
    }
    still = fingers.count === 0 ? { id: event.pointerId, x: event.offsetX, y: event.offsetY } : null;
    fingers.down(event.pointerId, event.clientX, event.clientY);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (still && Math.hypot(event.offsetX - still.x, event.offsetY - still.y) > STILL) still = null;
    const motion = fingers.move(event.pointerId, event.clientX, event.clientY);
    if (!motion) return;
    const side = Math.min(canvas.clientWidth, canvas.clientHeight);
    const turn = orbitBy(motion.dx, motion.dy, side, targetNow());
    add(turn.yaw, turn.pitch, pinchBy(motion.spread, targetNow()).forward);
  });
  canvas.addEventListener("pointerup", (event) => {
    if (still?.id === event.pointerId) click(still.x, still.y);
    if (push?.id !== event.pointerId) return;
    const { x, y } = push;
    send(pushBy(x, y, event.offsetX - x, event.offsetY - y, area()));
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
    canvas.addEventListener(end, (event) => {
      fingers.up(event.pointerId);
      if (still?.id === event.pointerId) still = null;
      if (push?.id === event.pointerId) push = null;
    });
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault(); // or a pinch on a touchpad would zoom the page
      add(0, 0, wheelBy(event.deltaY, event.deltaMode, targetNow()).forward);
    },
    { passive: false },
  );
}
