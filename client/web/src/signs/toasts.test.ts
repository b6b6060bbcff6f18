import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Toasts } from "./toasts";

/** As much of an element as toasts use. */
class FakeElement {
  readonly dataset: Record<string, string> = {};
  readonly classList = { add: () => undefined };
  readonly children: FakeElement[] = [];
  textContent = "";
  private parent: FakeElement | null = null;

  append(...more: FakeElement[]): void {
    for (const one of more) one.parent = this;
    this.children.push(...more);
  }

  remove(): void {
    const { children } = this.parent ?? this;
    if (this.parent) children.splice(children.indexOf(this), 1);
    this.parent = null;
  }

  setAttribute(): void {}
  addEventListener(): void {}
  querySelector(): null {
    return null;
  }
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("HTMLElement", FakeElement);
  vi.stubGlobal("document", { createElement: () => new FakeElement() });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function corner(): { toasts: Toasts; texts: () => (string | undefined)[] } {
  const region = new FakeElement();
  return {
    toasts: new Toasts(region as unknown as HTMLElement),
    texts: () => region.children.map((toast) => toast.children[0]?.textContent),
  };
}

it("a notice stays until what it tells of is done, whatever else comes", () => {
  const { toasts, texts } = corner();
  const clear = toasts.notice("rendering");
  for (const text of ["a", "b", "c", "d", "e"]) toasts.note(text);
  expect(texts()).toEqual(["rendering", "b", "c", "d", "e"]);
  vi.runAllTimers();
  expect(texts()).toEqual(["rendering"]);
  clear();
  expect(texts()).toEqual([]);
});

it("a task stays until it ends, whatever else comes", () => {
  const { toasts, texts } = corner();
  const { end } = toasts.task("saving", "Stop", () => undefined);
  for (const text of ["a", "b", "c", "d", "e"]) toasts.note(text);
  vi.runAllTimers();
  expect(texts()).toEqual(["saving"]);
  end();
  expect(texts()).toEqual([]);
});

it("of two notices of one text each stays as long as its own is not done", () => {
  const { toasts, texts } = corner();
  const [first, second] = [toasts.notice("rendering"), toasts.notice("rendering")];
  expect(texts()).toHaveLength(2);
  first();
  expect(texts()).toHaveLength(1);
  second();
  expect(texts()).toEqual([]);
});

it("of several problems about the same the newest is shown", () => {
  const { toasts, texts } = corner();
  toasts.problem("too steep", "angle");
  toasts.problem("too flat", "angle");
  expect(texts()).toEqual(["too flat"]);
});
