import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Acknowledged } from "./acknowledged";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

it("ends to wait with the answer to its own question, or when none will come", async () => {
  const asked: number[] = [];
  const acknowledged = new Acknowledged(({ number }) => asked.push(number));
  const done: string[] = [];
  for (const name of ["first", "second"]) void acknowledged.all().then(() => done.push(name));
  const [first, second] = asked;
  if (first === undefined || second === undefined) throw new Error("expected two questions");
  acknowledged.heard({ type: "reached", number: 1, step: 4 }); // somebody else's
  acknowledged.heard({ type: "reached", number: second, step: 4 });
  await vi.advanceTimersByTimeAsync(0);
  expect(done).toEqual(["second"]);
  expect(vi.getTimerCount()).toBe(1);
  await vi.runAllTimersAsync();
  expect(done).toEqual(["second", "first"]);
});
