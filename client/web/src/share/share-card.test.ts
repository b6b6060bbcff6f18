import { afterEach, expect, test, vi } from "vitest";
import { words } from "../words/words";
import { copyLink } from "./share-card";

afterEach(() => void vi.unstubAllGlobals());

const field = () => ({ value: "http://gem.test/?session=a", focus: vi.fn(), select: vi.fn() });

test("a link that is copied is said to be on the clipboard", async () => {
  const writeText = vi.fn(async () => undefined);
  vi.stubGlobal("navigator", { clipboard: { writeText } });
  const [link, status] = [field(), { textContent: "" }];
  await copyLink(link, status);
  expect(writeText).toHaveBeenCalledWith(link.value);
  expect(status.textContent).toBe(words.share.copied);
  expect(link.select).not.toHaveBeenCalled();
});

const REFUSALS = {
  "by plain http": {},
  "by permission": { clipboard: { writeText: () => Promise.reject(new Error("denied")) } },
};
test.each(Object.entries(REFUSALS))(
  "a link that may not be copied, %s, is selected, which is said",
  async (_, browser) => {
    vi.stubGlobal("navigator", browser);
    const [link, status] = [field(), { textContent: "" }];
    await copyLink(link, status);
    expect(link.select).toHaveBeenCalledOnce();
    expect(status.textContent).toBe(words.share.selected);
  },
);
