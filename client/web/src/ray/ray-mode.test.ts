import { expect, test, vi } from "vitest";
import { RayMode, type RayWorld } from "./ray-mode";

const view = vi.hoisted(() => ({ asked: [] as number[][], changes: 0, closed: 0 }));
vi.mock("./ray-view", () => ({
  RayView: class {
    ask(x: number, y: number) {
      view.asked.push([x, y]);
    }
    changed() {
      view.changes += 1;
    }
    close() {
      view.closed += 1;
    }
  },
}));

function mode(): { mode: RayMode; told: boolean[] } {
  const told: boolean[] = [];
  const complaints = { attempt: (work: () => unknown) => void work() };
  const world = { complaints, changed: (on: boolean) => void told.push(on) } as unknown as RayWorld;
  return { mode: new RayMode(world), told };
}

test("the mode begins with the ray of the picture's middle, and asks for that of each click until it ends", async () => {
  const { mode: ray, told } = mode();
  ray.ask({ x: 0.5, y: 0.5 });
  expect(view.asked).toEqual([]); // it is not on
  await ray.toggle();
  ray.ask({ x: 0.5, y: -0.5 });
  expect(view.asked).toEqual([
    [0, 0],
    [0.5, -0.5],
  ]);
  await ray.toggle();
  expect(view.closed).toBe(1);
  expect(told).toEqual([true, false]);
});

test("a ray is asked for again when the scene changes, and not when only the camera does", async () => {
  const { mode: ray } = mode();
  await ray.toggle();
  const before = { camera: { fov_degrees: 10 }, optics: {}, stones: [] };
  ray.changed(before, { ...before, camera: { fov_degrees: 20 } });
  expect(view.changes).toBe(0);
  ray.changed(before, { ...before, optics: {} });
  expect(view.changes).toBe(1);
  ray.changed(before, { camera: before.camera, optics: before.optics }); // the stones are gone
  expect(view.changes).toBe(2);
});
