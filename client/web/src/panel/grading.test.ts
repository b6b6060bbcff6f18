import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { ProblemError } from "../session/rest";
import { PAUSES } from "../session/stream";
import { Grading, PATIENCE_MS } from "./grading";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const BUSY = new ProblemError(429, "too many at once");

function gradingOf(ask: (tilt: boolean, signal: AbortSignal) => Promise<object>) {
  const asked = vi.fn(ask);
  const world = {
    ask: asked as (tilt: boolean, signal: AbortSignal) => Promise<Record<string, never>>,
    seen: vi.fn(() => true),
    busy: vi.fn(),
    outdated: vi.fn(),
    show: vi.fn(async () => undefined),
    fail: vi.fn(),
  };
  return { asked, world, grading: new Grading(world) };
}

test("a stone is graded once, when it has stayed as it is for a while", async () => {
  const { asked, world, grading } = gradingOf(async () => ({}));
  grading.refresh("round");
  await vi.advanceTimersByTimeAsync(PATIENCE_MS - 1);
  grading.refresh("oval");
  grading.refresh("oval");
  await vi.advanceTimersByTimeAsync(10 * PATIENCE_MS);
  expect(asked).toHaveBeenCalledTimes(1);
  expect(world.show).toHaveBeenCalledTimes(1);
  expect(world.busy).toHaveBeenLastCalledWith(false);
});

test("grades that a busy server did not give are asked for again until they come", async () => {
  let tries = 0;
  const { world, grading } = gradingOf(() => (++tries < 3 ? Promise.reject(BUSY) : Promise.resolve({})));
  grading.refresh("round");
  await vi.advanceTimersByTimeAsync(PATIENCE_MS);
  expect(world.fail).toHaveBeenLastCalledWith(BUSY.message);
  expect(world.busy).toHaveBeenLastCalledWith(false);
  await vi.advanceTimersByTimeAsync(Math.max(...PAUSES) * PAUSES.length);
  expect(tries).toBe(3);
  expect(world.show).toHaveBeenCalledTimes(1);
});

test("a busy server is left alone once nobody looks at the grades, and asked when somebody does again", async () => {
  const { asked, world, grading } = gradingOf(() => Promise.reject(BUSY));
  grading.refresh("round");
  await vi.advanceTimersByTimeAsync(PATIENCE_MS);
  world.seen.mockReturnValue(false);
  await vi.advanceTimersByTimeAsync(Math.max(...PAUSES) * PAUSES.length);
  expect(asked).toHaveBeenCalledTimes(1);
  grading.reopened("round");
  await vi.advanceTimersByTimeAsync(PATIENCE_MS);
  expect(asked).toHaveBeenCalledTimes(2);
});

test("a stone that cannot be graded is not asked for again with each change of something else", async () => {
  const { asked, world, grading } = gradingOf(() => Promise.reject(new ProblemError(422, "not closed")));
  for (let change = 0; change < 9; change++) {
    grading.refresh("open");
    await vi.advanceTimersByTimeAsync(10 * PATIENCE_MS);
  }
  expect(asked).toHaveBeenCalledTimes(1);
  expect(world.fail).toHaveBeenCalledWith("not closed");
});

test("tilt curves that are wanted right after a change of the stone are not given up", async () => {
  const { asked, world, grading } = gradingOf(
    (tilt, signal) =>
      new Promise((resolve, reject) => {
        setTimeout(() => resolve({ tilt }), 10 * PATIENCE_MS);
        signal.addEventListener("abort", () => reject(signal.reason));
      }),
  );
  grading.refresh("round");
  void grading.request(true);
  await vi.advanceTimersByTimeAsync(20 * PATIENCE_MS);
  expect(asked.mock.calls.map(([tilt]) => tilt)).toEqual([true]);
  expect(world.show.mock.calls).toEqual([[{ tilt: true }, expect.any(AbortSignal)]]);
});
