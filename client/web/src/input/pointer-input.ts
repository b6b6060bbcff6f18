/** Pointer and wheel events of the canvas, summed up and sent once an animation frame. */

import type { Rectangle } from "../picture/picture-size";
import type { Push, Target } from "../session/events";
import { Fingers, pinchBy, pushBy, turnBy, wheelBy } from "./gestures";
import type { Hand } from "./hand";
import type { Move } from "./moves";

/** Css pixels: by so little a finger moves that only taps. */
const STILL = 6;

export interface PointerWorld {
  target: () => Target;
  /** Of the target as it was when the move began. */
  move: (move: Move, target: Target) => void;
  push: (push: Push) => void;
  /** A click or tap, css pixels from the canvas' upper left corner. */
  click: (x: number, y: number) => void;
  /** With Ctrl, or Cmd on a Mac, a hand takes the stone under the pointer. */
  hand: Hand;
  /** Where the picture is on the canvas, css pixels. */
  area: () => Rectangle;
  /** Whether a turn of the wheel is the picture's, or that of the page that it stands in. */
  zooms: (event: WheelEvent) => boolean;
}

/** A pointer that is down, and where that was, css pixels of the canvas. */
interface Down {
  id: number;
  x: number;
  y: number;
}

export function listenToPointers(canvas: HTMLCanvasElement, world: PointerWorld): void {
  const fingers = new Fingers();
  let pending: { target: Target; yaw: number; pitch: number; forward: number } | null = null;

  /** A pointer that went down alone and has not been moved since. */
  let still: Down | null = null;
  /** A push is given when its pointer goes up. */
  let push: Down | null = null;
  /** Where the pointer was last that leads the hand. */
  let led: Down | null = null;

  function flush(): void {
    if (!pending) return;
    const { target, ...move } = pending;
    pending = null;
    world.move(move, target);
  }

  function add(yaw: number, pitch: number, forward: number): void {
    if (!pending) {
      pending = { target: world.target(), yaw: 0, pitch: 0, forward: 0 };
      requestAnimationFrame(flush);
    }
    pending.yaw += yaw;
    pending.pitch += pitch;
    pending.forward += forward;
  }

  /** While the hand holds something. */
  function handOn(): void {
    if (!led) return;
    world.hand.flush();
    requestAnimationFrame(handOn);
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    const down = { id: event.pointerId, x: event.offsetX, y: event.offsetY };
    if (event.ctrlKey || event.metaKey) {
      led = down;
      world.hand.take(down.x, down.y);
      handOn();
      return;
    }
    if (event.shiftKey) {
      push = down;
      return;
    }
    still = fingers.count === 0 ? down : null;
    fingers.down(event.pointerId, event.clientX, event.clientY);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (led?.id === event.pointerId) {
      world.hand.move(event.offsetX - led.x, event.offsetY - led.y, event.shiftKey);
      led = { id: led.id, x: event.offsetX, y: event.offsetY };
      return;
    }
    if (still && Math.hypot(event.offsetX - still.x, event.offsetY - still.y) > STILL) still = null;
    const motion = fingers.move(event.pointerId, event.clientX, event.clientY);
    if (!motion) return;
    const side = Math.min(canvas.clientWidth, canvas.clientHeight);
    const { yaw, pitch } = turnBy(motion.dx, motion.dy, side, world.target());
    add(yaw, pitch, pinchBy(motion.spread));
  });
  canvas.addEventListener("pointerup", (event) => {
    if (still?.id === event.pointerId) world.click(still.x, still.y);
    if (push?.id !== event.pointerId) return;
    const { x, y } = push;
    world.push(pushBy(x, y, event.offsetX - x, event.offsetY - y, world.area()));
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
    canvas.addEventListener(end, (event) => {
      fingers.up(event.pointerId);
      if (still?.id === event.pointerId) still = null;
      if (push?.id === event.pointerId) push = null;
      if (led?.id === event.pointerId) {
        led = null;
        world.hand.letGo();
      }
    });
  }
  // Ctrl and a click is a Mac's way to the context menu, and a hand's here.
  canvas.addEventListener("contextmenu", (event) => event.ctrlKey && event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!world.zooms(event)) return;
      event.preventDefault(); // or a pinch on a touchpad would zoom the page
      add(0, 0, wheelBy(event.deltaY, event.deltaMode));
    },
    { passive: false },
  );
}
