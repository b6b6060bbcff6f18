/** A link to a view: the scene as it was seen, in the part of the address after the hash, which no server is sent. */

import type { JsonObject } from "@culet/protocol/messages";
import { number, object } from "../json";
import { framed } from "../picture/framing";
import { words } from "../words/words";

/** Of the form in which views are packed; it begins the packed view. */
const VERSION = "1.";
const KEY = "view";
/** Bytes that a packed view may unpack to, as many as the server takes for a scene: an address may come from anywhere. */
const MOST_BYTES = 2 ** 20;

export interface SeenView {
  /** With the camera and the stones as they were seen. */
  scene: JsonObject;
  /** Of the picture: width by height. */
  aspect: number;
}

/** Of a link that cannot be read; the message is fit to be shown. */
export class LinkError extends Error {
  override name = "LinkError";
}

/** The address that shows a view on the server of this page. */
export async function viewAddress(view: SeenView, page: string): Promise<string> {
  const packed = await through(new TextEncoder().encode(JSON.stringify(view)), new CompressionStream("deflate-raw"));
  return new URL(`./#${KEY}=${VERSION}${base64url(packed)}`, page).href;
}

/** What the part of an address after the hash says of a view, or null if that says nothing of one. */
export function packedView(hash: string): string | null {
  return new URLSearchParams(hash.replace(/^#/, "")).get(KEY);
}

/** The view that was packed; throws LinkError. */
export async function unpackedView(packed: string): Promise<SeenView> {
  if (!packed.startsWith(VERSION)) throw new LinkError(words.address.otherVersion);
  let view: JsonObject;
  try {
    const bytes = await through(
      bytesOf(packed.slice(VERSION.length)),
      new DecompressionStream("deflate-raw"),
      MOST_BYTES,
    );
    view = object(JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes)));
  } catch {
    throw new LinkError(words.address.damaged);
  }
  if (typeof view.scene !== "object" || view.scene === null || Array.isArray(view.scene)) {
    throw new LinkError(words.address.noScene);
  }
  return { scene: view.scene as JsonObject, aspect: number(view.aspect, 0) };
}

/** The scene of a view for a picture of another shape: a narrower one needs more room, a wider one shows more. */
export function fitted({ scene, aspect }: SeenView, now: number): JsonObject {
  return now < aspect ? framed(scene, now) : scene;
}

/** All that a stream makes of some bytes; throws RangeError if that is more than `most`. */
async function through(
  bytes: Uint8Array<ArrayBuffer>,
  stream: ReadableWritablePair<Uint8Array, BufferSource>,
  most = Number.POSITIVE_INFINITY,
): Promise<Uint8Array<ArrayBuffer>> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  for (let { done, value } = await reader.read(); !done && value; { done, value } = await reader.read()) {
    length += value.length;
    if (length > most) {
      await reader.cancel();
      throw new RangeError(`expected at most ${most} bytes`);
    }
    parts.push(new Uint8Array(value));
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** RFC 4648, section 5, without padding. */
function base64url(bytes: Uint8Array): string {
  const binary = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
}
