/** The clipboard, where the browser lets a page write to it. */

/** Why a browser keeps the clipboard to itself: it is there for pages that came by https, or from the same machine. */
const INSECURE = "The browser gives the clipboard only to pages that came by https, or from this machine";
const REFUSED = "The browser did not let the page write to the clipboard";

/** Put a picture there once it has been rendered; throws Error with words for the user, and with what to do instead. */
export async function copyPicture(render: () => Promise<Blob>): Promise<void> {
  if (!hasClipboard()) throw new Error(`${INSECURE}: S saves the picture instead.`);
  if (typeof ClipboardItem === "undefined") throw new Error("This browser copies no pictures: S saves the picture.");
  const picture = render();
  // A promise, and at once: Safari forgets that a key was pressed if the picture is waited for first.
  await written(() => navigator.clipboard.write([new ClipboardItem({ "image/png": picture })]), picture, "S saves it.");
}

/** Put a text there; throws Error that has the text, so that the user can copy it by hand. */
export async function copyText(text: string): Promise<void> {
  if (!hasClipboard()) throw new Error(`${INSECURE}. To be copied by hand:\n${text}`);
  await written(() => navigator.clipboard.writeText(text), Promise.resolve(), `To be copied by hand:\n${text}`);
}

/** Whether there is one: the types promise that, and pages that came by plain http have none. */
function hasClipboard(): boolean {
  return (navigator as Partial<Navigator>).clipboard !== undefined;
}

async function written(write: () => Promise<void>, content: Promise<unknown>, instead: string): Promise<void> {
  try {
    await write();
  } catch (error) {
    await content; // it may be the content that could not be had
    throw new Error(`${REFUSED} (${error instanceof Error ? error.message : error}). ${instead}`);
  }
}
