import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { PATIENCE_MS, Settling } from "./settling";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test("the picture fills a window of another shape until one of that shape comes", () => {
  const ended = vi.fn();
  const settling = new Settling(ended);
  expect(settling.on).toBe(false);
  settling.resized(true);
  expect(settling.on).toBe(true);
  settling.shown(false); // on its way when the window was turned
  settling.resized(false); // and turned further
  expect(settling.on).toBe(true);
  settling.shown(true);
  expect(settling.on).toBe(false);
  vi.advanceTimersByTime(2 * PATIENCE_MS);
  expect(ended).not.toHaveBeenCalled();
});

test("a picture whose shape another window decides on is shown whole in the end", () => {
  const ended = vi.fn();
  const settling = new Settling(ended);
  settling.resized(false); // it never had this window's shape
  expect(settling.on).toBe(false);
  settling.resized(true);
  vi.advanceTimersByTime(PATIENCE_MS);
  expect(ended).toHaveBeenCalledTimes(1);
  expect(settling.on).toBe(false);
});
