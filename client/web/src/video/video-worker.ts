/** The worker that tries and uses the browser's decoders, so that no picture waits for the page, nor the page for one. */

import { bitmapOf } from "./bitmap";
import type { VideoCodec } from "./codec-string";
import { PacketDecoder, type VideoPacket } from "./packet-decoder";
import { trusted } from "./trial";

export type Work = { id: number } & ({ kind: "try"; codecs: VideoCodec[] } | { kind: "decode"; packet: VideoPacket });

export type Done = { id: number } & ({ codecs: VideoCodec[] } | { picture: ImageBitmap } | { error: string });

const decoder = new PacketDecoder();
const port = self as unknown as { postMessage: (done: Done, transfer?: Transferable[]) => void };

async function done(work: Work): Promise<void> {
  const { id } = work;
  try {
    if (work.kind === "try") port.postMessage({ id, codecs: await trusted(work.codecs) });
    else {
      const picture = bitmapOf(await decoder.decode(work.packet));
      port.postMessage({ id, picture }, [picture]);
    }
  } catch (error) {
    port.postMessage({ id, error: error instanceof Error ? error.message : String(error) });
  }
}

self.addEventListener("message", ({ data }: MessageEvent<Work>) => void done(data));
