/** The page's side of the worker that decodes video: asked, it answers, or says why not. */

import type { VideoCodec } from "./codec-string";
import type { VideoPacket } from "./packet-decoder";
import type { Done, Work } from "./video-worker";

interface Asked {
  resolve: (done: Done) => void;
  reject: (reason: Error) => void;
}

/** What of a worker is needed here. */
export type Port = Pick<Worker, "postMessage" | "terminate" | "onmessage" | "onerror">;

function newWorker(): Port {
  return new Worker(new URL("./video-worker.ts", import.meta.url), { type: "module" });
}

export class VideoWork {
  private readonly port: Port;
  private readonly asked = new Map<number, Asked>();
  private asks = 0;
  /** Why nothing is decoded any more. */
  private ended: string | null = null;

  constructor(port: Port = newWorker()) {
    this.port = port;
    port.onmessage = ({ data }: MessageEvent<Done>) => {
      const asked = this.asked.get(data.id);
      this.asked.delete(data.id);
      asked?.resolve(data);
    };
    port.onerror = (event) => this.end(`expected a worker that works, got ${event.type}`);
  }

  /** Those of the codecs that this browser decodes as it should. */
  async trusted(codecs: readonly VideoCodec[]): Promise<VideoCodec[]> {
    const done = await this.ask({ id: 0, kind: "try", codecs: [...codecs] });
    return "codecs" in done ? done.codecs : [];
  }

  /** The picture of a packet; an Error if there is none, after which a key frame must come. */
  async decode(packet: VideoPacket): Promise<ImageBitmap> {
    const done = await this.ask({ id: 0, kind: "decode", packet });
    if ("picture" in done) return done.picture;
    throw new Error("error" in done ? done.error : "expected a picture, got codecs");
  }

  /** Nothing is decoded any more. */
  end(why = "expected pictures of nothing more"): void {
    this.ended ??= why;
    this.port.terminate();
    const all = [...this.asked.values()];
    this.asked.clear();
    for (const { reject } of all) reject(new Error(why));
  }

  private ask(work: Work): Promise<Done> {
    if (this.ended !== null) return Promise.reject(new Error(this.ended)); // a worker that has ended answers nothing
    this.asks += 1;
    const id = this.asks;
    return new Promise((resolve, reject) => {
      this.asked.set(id, { resolve, reject });
      this.port.postMessage({ ...work, id });
    });
  }
}
