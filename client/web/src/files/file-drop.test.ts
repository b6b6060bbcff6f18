import { expect, it, test, vi } from "vitest";
import { kindOf, listenToDrops } from "./file-drop";

test.each([
  ["a.json", "scene"],
  ["marquise.asc", "mesh"],
  ["PC01.GEM", "mesh"],
  ["new.design.gcs", "mesh"],
  ["stone.obj", "mesh"],
  ["sunset.exr", "sky"],
  ["letter.doc", null],
  ["asc", null],
  ["json", null],
])("%s is opened as %s", (name, kind) => {
  expect(kindOf(name)).toBe(kind);
});

function dropped(...names: string[]) {
  const heard = new Map<string, (event: unknown) => void>();
  const opens = { scene: vi.fn(), mesh: vi.fn(), sky: vi.fn() };
  const refuse = vi.fn();
  const target = { addEventListener: (name: string, act: (event: unknown) => void) => heard.set(name, act) };
  listenToDrops(target as unknown as Window, opens, refuse);
  const fire = (name: string, types: string[]) => {
    const event = { dataTransfer: { types, files: names.map((file) => ({ name: file })) }, preventDefault: vi.fn() };
    heard.get(name)?.(event);
    return event.preventDefault.mock.calls.length > 0;
  };
  return { opens, refuse, fire };
}

it("opens each file that is dropped, and says which it cannot", () => {
  const { opens, refuse, fire } = dropped("a.asc", "letter.doc", "b.hdr");
  expect(fire("dragover", ["Files"])).toBe(true);
  expect(opens.mesh).not.toHaveBeenCalled();
  expect(fire("drop", ["Files"])).toBe(true);
  expect(opens.mesh).toHaveBeenCalledExactlyOnceWith({ name: "a.asc" });
  expect(opens.sky).toHaveBeenCalledExactlyOnceWith({ name: "b.hdr" });
  expect(refuse).toHaveBeenCalledOnce();
  expect(refuse.mock.calls[0]?.[0]).toContain("letter.doc: expected a scene (.json), a mesh or design (.obj .off");
});

it("leaves alone what is no file: text that is dragged into a field", () => {
  const { opens, fire } = dropped("a.asc");
  expect(fire("dragover", ["text/plain"])).toBe(false);
  expect(fire("drop", ["text/plain"])).toBe(false);
  expect(opens.mesh).not.toHaveBeenCalled();
});
