/** The picture under pointer and hand: what drags, wheels, clicks and throws on it lead to. */

import type { ChosenStone } from "../picture/chosen-stone";
import type { Embedding, Turntable } from "../picture/embedding";
import type { Screen } from "../picture/screen";
import type { RayMode } from "../ray/ray-mode";
import type { Visit } from "../session/visit";
import type { Bareness } from "../signs/bareness";
import { idsOf } from "../stones/stones";
import { placeOf } from "./gestures";
import { Hand } from "./hand";
import type { Performing } from "./performing";
import { listenToPointers } from "./pointer-input";

export interface Steered {
  canvas: HTMLCanvasElement;
  screen: Screen;
  visit: Visit;
  chosen: ChosenStone;
  performing: Performing;
  turntable: Turntable;
  bareness: Bareness;
  embedding: Embedding;
  ray: RayMode;
}

export function steer({
  canvas,
  screen,
  visit,
  chosen,
  performing,
  turntable,
  bareness,
  embedding,
  ray,
}: Steered): void {
  const pick = (x: number, y: number, told?: (id: string | null) => void) => {
    const at = placeOf(x, y, screen.area);
    chosen.pick(at.x, at.y, told);
  };
  const hand = new Hand({
    ids: () => idsOf(visit.scene),
    pick,
    send: (event) => visit.send(event),
    size: () => ({ height: screen.area.height, side: Math.min(canvas.clientWidth, canvas.clientHeight) }),
  });
  listenToPointers(canvas, {
    target: () => visit.state.target,
    move: (move, target) => performing.move(move, target),
    push: (push) => visit.send(push),
    click: (x, y) => {
      turntable.toggle();
      if (!embedding.ui) return;
      if (bareness.on) bareness.toggle();
      else if (ray.on) ray.ask(placeOf(x, y, screen.area));
      else if (idsOf(visit.scene).length > 1) pick(x, y);
    },
    hand,
    area: () => screen.area,
    zooms: (event) => embedding.ui || event.ctrlKey, // a pinch of a touchpad counts as with Ctrl
  });
}
