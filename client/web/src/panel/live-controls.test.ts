import { afterEach, beforeEach, expect, it, vi } from "vitest";
import type { Control } from "../controls/control";
import { LiveControls } from "./live-controls";

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("requestAnimationFrame", (work: () => void) => setTimeout(work, 16));
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A slider under a finger, and a server that is done with what it was sent when it is told to be. */
function dragged(acknowledges: boolean) {
  const [sent, done]: [number[], (() => void)[]] = [[], []];
  const server = { angle: 41 };
  const slider = { value: 0, input: (_: number): void => undefined, settled: (): void => undefined };
  const control = {
    set value(value: number) {
      slider.value = value;
    },
    onInput: (listener: (value: number) => void) => void Object.assign(slider, { input: listener }),
    onSettled: (listener: () => void) => void Object.assign(slider, { settled: listener }),
  };
  const controls = new LiveControls<{ angle: number }>(
    () => ({ ...server }),
    (_, value) => void sent.push(value),
    acknowledges ? () => new Promise((end) => done.push(end)) : null,
  );
  controls.listen("angle", control as unknown as Control<number>);
  return { sent, done, server, slider, controls };
}

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

it("sends the newest value once the server is done with the one before, and none between", async () => {
  const { sent, done, server, slider } = dragged(true);
  for (const value of [41.1, 41.2, 41.3]) {
    slider.input(value);
    await pass(100);
  }
  slider.settled();
  expect(sent).toEqual([41.1]);
  await pass(5000);
  expect([sent, slider.value]).toEqual([[41.1], 41.3]); // where it was let go
  server.angle = 41.1;
  done[0]?.();
  await pass(100);
  expect(sent).toEqual([41.1, 41.3]);
  await pass(5000);
  expect(slider.value).toBe(41.3);
  server.angle = 41.25; // or what else it made of that
  done[1]?.();
  await pass(5000);
  expect([sent, slider.value]).toEqual([[41.1, 41.3], 41.25]);
});

it("sends nothing that waits once something else was done", async () => {
  const { sent, done, slider, controls } = dragged(true);
  slider.input(41.1);
  await pass(100);
  slider.input(41.2);
  controls.forget();
  done[0]?.();
  await pass(100);
  expect(sent).toEqual([41.1]);
  slider.input(41.3);
  controls.forget(); // before the next picture
  await pass(100);
  slider.input(41.4);
  await pass(100);
  expect(sent).toEqual([41.1, 41.4]);
});

it("waits for no answer where none is told of", async () => {
  const { sent, slider } = dragged(false);
  for (const value of [41.1, 41.2, 41.3]) slider.input(value);
  await pass(100);
  slider.input(41.4);
  await pass(100);
  expect(sent).toEqual([41.3, 41.4]);
});
