/** Where a viewer's pictures come from, by the attributes of its element. */

/** The server, and what of it is shown; null: what the server takes by itself. */
export interface Wanted {
  /** Of the server, such as https://gems.example or https://shop.example/gems. */
  src: string;
  preset: string | null;
  /** The watch id of a session that somebody else moves, in place of one of the viewer's own. */
  watch: string | null;
  /** Degrees a second. */
  rotate: string | null;
  /** Behind everything: a colour of six hexadecimal digits, with # or without. */
  background: string | null;
}

/** Pixels of the longer side of posters: few sizes, so that caches along the way have them. */
const SIDES = [320, 480, 640, 960, 1280];
/** Pixels: the other side is a multiple. */
const STEP = 16;

/** What the server's own addresses begin with: a proxy may have the server in a folder. */
function folder(src: string): string {
  return src.endsWith("/") ? src : `${src}/`;
}

/** A colour without its #, which would look odd in an address. */
function bare(colour: string): string {
  return colour.replace("#", "");
}

/** The live picture, for an iframe. */
export function frameAddress({ src, preset, watch, rotate, background }: Wanted): string {
  const address = new URL(folder(src));
  address.searchParams.set("ui", "0");
  if (watch !== null) address.searchParams.set("watch", watch);
  else if (preset !== null) address.searchParams.set("preset", preset);
  if (watch === null && background !== null) address.searchParams.set("background", bare(background));
  if (rotate !== null) address.searchParams.set("rotate", rotate);
  return address.href;
}

/** A still of the same, as large as that area of css pixels or a little larger. */
export function posterAddress(
  { src, preset, watch, background }: Wanted,
  width: number,
  height: number,
  ratio: number,
): string {
  const long = Math.max(width, height, 1) * ratio;
  const side = SIDES.find((each) => each >= long) ?? (SIDES.at(-1) as number);
  const pixels = (length: number) => Math.max(STEP, Math.round((side * length * ratio) / long / STEP) * STEP);
  const path = watch === null ? "api/render.webp" : `api/sessions/${encodeURIComponent(watch)}/frame.webp`;
  const address = new URL(path, folder(src));
  if (watch === null && preset !== null) address.searchParams.set("preset", preset);
  if (watch === null && background !== null) address.searchParams.set("background", bare(background));
  address.searchParams.set("width", String(pixels(width)));
  address.searchParams.set("height", String(pixels(height)));
  return address.href;
}
