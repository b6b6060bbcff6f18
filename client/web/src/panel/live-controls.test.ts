import { afterEach, beforeEach, expect, it, vi } from "vitest";
import type { Control } from "../controls/control";
import { LiveControls } from "./live-controls";
import type { Steps } from "./steps";

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("requestAnimationFrame", (work: () => void) => setTimeout(work, 16));
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A slider under a finger, and a server that is done with what it was sent, or gives it up, when it is told to. */
function dragged(acknowledges: boolean) {
  const [sent, done, failed]: [number[], ((why?: string) => void)[], string[]] = [[], [], []];
  const work = { now: false };
  const steps: Steps = {
    after: (send) => {
      send();
      return new Promise((end) => done.push((why) => end(why ?? null)));
    },
    working: () => {
      work.now = true;
      return () => {
        work.now = false;
      };
    },
    failed: (why) => failed.push(why),
  };
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
    acknowledges ? steps : null,
  );
  controls.listen("angle", control as unknown as Control<number>);
  return { sent, done, failed, work, server, slider, controls };
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

it("sends a value again that was given up, and stays at it meanwhile", async () => {
  const { sent, done, failed, work, slider } = dragged(true);
  slider.input(41.3);
  slider.settled();
  await pass(100);
  expect(work.now).toBe(true);
  done[0]?.("try again later");
  await pass(2000);
  expect([sent, slider.value, work.now]).toEqual([[41.3, 41.3], 41.3, true]);
  done[1]?.();
  await pass(5000);
  expect([sent, slider.value, work.now]).toEqual([[41.3, 41.3], 41, false]); // as the server has it by then
  expect(failed).toEqual([]);
});

it("sends the newest value in place of one that was given up", async () => {
  const { sent, done, failed, slider } = dragged(true);
  slider.input(41.3);
  await pass(100);
  slider.input(41.4);
  done[0]?.("try again later");
  await pass(2000);
  done[1]?.();
  await pass(2000);
  expect([sent, failed]).toEqual([[41.3, 41.4], []]);
});

it("tells why a value was given up again and again, or that something else was done meanwhile", async () => {
  const { sent, done, failed, slider, controls } = dragged(true);
  slider.input(41.3);
  await pass(100);
  for (let tries = 0; tries < 10; tries++) {
    done[tries]?.("try again later");
    await pass(2000);
  }
  expect([sent.length, failed]).toEqual([6, ["try again later"]]);
  slider.input(41.5);
  await pass(100);
  controls.forget();
  done[6]?.("not done");
  await pass(2000);
  expect([sent.length, failed]).toEqual([7, ["try again later", "not done"]]);
});
