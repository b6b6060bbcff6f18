import { afterEach, expect, it, vi } from "vitest";
import { copyPicture, copyText } from "./clipboard";

class Item {
  readonly parts: Record<string, Promise<Blob>>;

  constructor(parts: Record<string, Promise<Blob>>) {
    this.parts = parts;
  }
}

const PICTURE = new Blob(["picture"], { type: "image/png" });

afterEach(() => vi.unstubAllGlobals());

it("is given the picture as a promise, before the picture is there", async () => {
  const written: Item[] = [];
  vi.stubGlobal("ClipboardItem", Item);
  vi.stubGlobal("navigator", { clipboard: { write: async (items: Item[]) => void written.push(...items) } });
  let rendered: (picture: Blob) => void = () => undefined;
  const picture = new Promise<Blob>((resolve) => {
    rendered = resolve;
  });
  const copied = copyPicture(() => picture);
  expect(written).toHaveLength(1);
  rendered(PICTURE);
  await copied;
  expect(await written[0]?.parts["image/png"]).toBe(PICTURE);
});

it("is given a text as a promise too, or the text where the browser takes no promises", async () => {
  const written: (Item | string)[] = [];
  const clipboard = {
    write: async (items: Item[]) => void written.push(...items),
    writeText: async (text: string) => void written.push(text),
  };
  vi.stubGlobal("navigator", { clipboard });
  await copyText(async () => "a text");
  expect(written).toEqual(["a text"]);
  vi.stubGlobal("ClipboardItem", Item);
  let made: (text: string) => void = () => undefined;
  const copied = copyText(() => new Promise((resolve) => (made = resolve)));
  expect(written).toHaveLength(2);
  made("a link");
  await copied;
  const item = written[1] as Item;
  expect(await (await item.parts["text/plain"])?.text()).toBe("a link");
});

it("that there is not, as by plain http, is told with what to do instead", async () => {
  vi.stubGlobal("navigator", {});
  const render = vi.fn(async () => PICTURE);
  await expect(copyPicture(render)).rejects.toThrow(/https.*S saves the picture/);
  expect(render).not.toHaveBeenCalled();
  await expect(copyText(async () => "https://gems.example/#view=1.A")).rejects.toThrow(
    /https[\s\S]*gems\.example\/#view=1\.A$/,
  );
});

it("that refuses says why, and the text is there to be copied by hand", async () => {
  const refuse = async () => {
    throw new DOMException("Document is not focused.", "NotAllowedError");
  };
  vi.stubGlobal("ClipboardItem", Item);
  vi.stubGlobal("navigator", { clipboard: { write: refuse, writeText: refuse } });
  await expect(copyText(async () => "a text")).rejects.toThrow(/not focused[\s\S]*a text$/);
  await expect(copyPicture(async () => PICTURE)).rejects.toThrow(/not focused.*S saves it/);
});

it("is not blamed for a picture that could not be rendered", async () => {
  vi.stubGlobal("ClipboardItem", Item);
  vi.stubGlobal("navigator", { clipboard: { write: ([item]: [Item]) => item.parts["image/png"] } });
  await expect(copyPicture(() => Promise.reject(new Error("the engine is down")))).rejects.toThrow(
    "the engine is down",
  );
});
