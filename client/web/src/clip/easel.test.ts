import { afterEach, expect, test, vi } from "vitest";
import { Easel } from "./easel";

afterEach(() => void vi.unstubAllGlobals());

test("of the pictures that are shown none is kept once another one comes, nor once the easel is closed", async () => {
  const context = { fillRect: vi.fn(), drawImage: vi.fn() };
  const canvas = { width: 0, height: 0, getContext: () => context };
  vi.stubGlobal("document", { createElement: () => canvas });
  let open = 0;
  vi.stubGlobal("createImageBitmap", async () => {
    open += 1;
    return { width: 16, height: 16, close: () => (open -= 1) };
  });
  const frame = {
    time: 0,
    step: 1n,
    atRest: true,
    width: 16,
    height: 16,
    content: { payload: new Uint8Array(1), type: "image/png" },
  };
  const easel = new Easel({ width: 16, height: 16 });
  for (const step of [1n, 2n]) await easel.show({ ...frame, step });
  expect(open).toBe(1);
  easel.close();
  expect(open).toBe(0);
  expect(context.drawImage).toHaveBeenCalledTimes(2);
});
