/** The clipboard, where the browser lets a page write to it. */

import { words } from "../words/words";

/** Put a picture there once it has been rendered; throws Error with words for the user, and with what to do instead. */
export async function copyPicture(render: () => Promise<Blob>): Promise<void> {
  if (!hasClipboard()) throw new Error(words.clipboard.insecurePicture);
  if (typeof ClipboardItem === "undefined") throw new Error(words.clipboard.noPictures);
  const picture = render();
  try {
    // A promise, and at once: Safari forgets that a key was pressed if the picture is waited for first.
    await navigator.clipboard.write([new ClipboardItem({ "image/png": picture })]);
  } catch (error) {
    await picture; // it may be the picture that could not be had
    throw new Error(words.clipboard.refusedPicture(reasonOf(error)));
  }
}

/** Put a text there once it has been made; throws Error that has the text, so that the user can copy it by hand. */
export async function copyText(make: () => Promise<string>): Promise<void> {
  const text = make();
  if (!hasClipboard()) throw new Error(words.clipboard.insecureText(await text));
  const promised = typeof ClipboardItem !== "undefined";
  const write = async () =>
    promised // as a picture
      ? navigator.clipboard.write([new ClipboardItem({ "text/plain": text.then(plain) })])
      : navigator.clipboard.writeText(await text);
  try {
    await write();
  } catch (error) {
    throw new Error(words.clipboard.refusedText(reasonOf(error), await text)); // or why there is none
  }
}

function plain(text: string): Blob {
  return new Blob([text], { type: "text/plain" });
}

/** Whether there is one: the types promise that, and pages that came by plain http have none. */
function hasClipboard(): boolean {
  return (navigator as Partial<Navigator>).clipboard !== undefined;
}

function reasonOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
