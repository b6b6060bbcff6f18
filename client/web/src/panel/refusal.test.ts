import { expect, it, vi } from "vitest";
import { Refusal } from "./refusal";

it("a refusal stays as long as what was refused is there, or until the control is used again", () => {
  const element = { textContent: "", hidden: false, setAttribute: vi.fn() };
  vi.stubGlobal("document", { createElement: () => element });
  const refusal = new Refusal();
  expect(element.hidden).toBe(true);
  refusal.tell("expected less", "a");
  refusal.about("a");
  expect(element).toMatchObject({ textContent: "expected less", hidden: false });
  refusal.about("b");
  expect(element.hidden).toBe(true);
  refusal.about("a");
  expect(element.hidden).toBe(true);
  refusal.tell("expected more", "b");
  refusal.hide();
  expect(element.hidden).toBe(true);
  vi.unstubAllGlobals();
});
