import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { slowly } from "./slowly";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

it("tells of what takes a while until that ends, and of nothing else", async () => {
  const told: string[] = [];
  const tell = () => {
    told.push("working");
    return () => void told.push("done");
  };
  const quick = slowly(tell);
  await vi.advanceTimersByTimeAsync(100);
  quick();
  const slow = slowly(tell);
  await vi.advanceTimersByTimeAsync(5000);
  expect(told).toEqual(["working"]);
  slow();
  expect(told).toEqual(["working", "done"]);
});
