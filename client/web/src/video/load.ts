/** Decoding of video, loaded when a server makes some: browsers have it on pages from a secure place alone. */

import type { VideoWork } from "./video-work";

export async function loadVideo(): Promise<VideoWork | null> {
  if (!("VideoDecoder" in globalThis && "OffscreenCanvas" in globalThis)) return null;
  const { VideoWork } = await import("./video-work");
  return new VideoWork();
}
