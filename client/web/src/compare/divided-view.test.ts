import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { words } from "../words/words";
import { DividedView } from "./divided-view";
import type { DivisionWorld } from "./division";

const rest = vi.hoisted(() => ({ sceneShown: vi.fn(), beside: vi.fn() }));
vi.mock("../session/rest", () => rest);
vi.mock("./divided.css", () => ({}));
vi.mock("../page", () => ({ element: () => ({ after: () => undefined }) }));

const { keptSide, keptWaits } = words.compare;

/** Everything that the view makes of elements. */
const made: { tag: string; textContent?: string; hidden?: boolean }[] = [];

beforeEach(() => {
  made.length = 0;
  vi.useFakeTimers();
  vi.stubGlobal("SVGSVGElement", class {});
  vi.stubGlobal("document", {
    createElement: (tag: string) => {
      const element = {
        tag,
        dataset: {},
        style: { setProperty: () => undefined },
        setAttribute: () => undefined,
        append: () => undefined,
        decode: async () => undefined,
      };
      made.push(element);
      return element;
    },
  });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A view of a picture at rest, and what it complained of. */
function view(session: string | null, differs = true): { divided: DividedView; told: unknown[] } {
  const told: unknown[] = [];
  const world = {
    visit: { session, scene: {}, lastFrame: { step: 1n, width: 4, height: 3 } },
    canvas: { width: 4, height: 3 },
    comparison: { beside: () => (differs ? { stone: "a", design: {} } : null) },
    complaints: { attempt: (work: () => Promise<void>) => void work().catch((error: unknown) => told.push(error)) },
  };
  return { divided: new DividedView(world as unknown as DivisionWorld), told };
}

/** The first picture comes, or is refused, when that is called; a second one never comes. */
function asked(): { come: (picture: Blob) => void; refuse: (why: Error) => void } {
  const settle = { come: (_: Blob): void => undefined, refuse: (_: Error): void => undefined };
  const first = new Promise<Blob>((come, refuse) => Object.assign(settle, { come, refuse }));
  rest.sceneShown.mockReset().mockResolvedValue({});
  rest.beside
    .mockReset()
    .mockReturnValueOnce(first)
    .mockReturnValue(new Promise(() => undefined));
  return settle;
}

const caption = () => made.find(({ tag }) => tag === "span")?.textContent;
const hidden = () => made.find(({ tag }) => tag === "img")?.hidden;

it("says that the kept design's side is being rendered from when it is asked for until it is there", async () => {
  const { come } = asked();
  const { told } = view("s");
  expect(caption()).toBe(keptSide);
  await vi.runAllTimersAsync();
  expect([caption(), hidden()]).toEqual([keptWaits, true]);
  come(new Blob());
  await vi.runAllTimersAsync();
  expect([caption(), hidden()]).toEqual([keptSide, false]);
  expect(told).toEqual([]);
});

it("does not say so any more once that was refused", async () => {
  const { refuse } = asked();
  const { told } = view("s");
  await vi.runAllTimersAsync();
  expect(caption()).toBe(keptWaits);
  refuse(new Error("busy"));
  await vi.runAllTimersAsync();
  expect([caption(), hidden()]).toEqual([keptSide, true]);
  expect(told).toEqual([new Error("busy")]);
});

it.each([
  ["there is no session", null, true],
  ["the kept design is the shown one", "s", false],
] as const)("does not say so where nothing is asked, as %s", async (_, session, differs) => {
  asked();
  view(session, differs);
  await vi.runAllTimersAsync();
  expect(caption()).toBe(keptSide);
  expect(rest.beside).not.toHaveBeenCalled();
});

it("says nothing more of what was given up for another picture", async () => {
  const { refuse } = asked();
  const { divided, told } = view("s");
  await vi.runAllTimersAsync();
  divided.changed();
  expect(caption()).toBe(keptSide);
  await vi.runAllTimersAsync();
  expect(caption()).toBe(keptWaits); // for the next one
  refuse(new Error("aborted"));
  await vi.runAllTimersAsync();
  expect([caption(), told]).toEqual([keptWaits, []]);
});

it("asks for nothing once another picture has come before the scene of the first", async () => {
  asked();
  const scene = { come: (_: object): void => undefined };
  rest.sceneShown.mockReturnValueOnce(new Promise((come) => Object.assign(scene, { come })));
  const { divided } = view("s");
  await vi.runAllTimersAsync();
  divided.changed();
  scene.come({});
  await vi.advanceTimersByTimeAsync(0);
  expect(caption()).toBe(keptSide);
  expect(rest.beside).not.toHaveBeenCalled();
});
