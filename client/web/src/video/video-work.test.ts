import { beforeEach, expect, it } from "vitest";
import type { VideoPacket } from "./packet-decoder";
import { type Port, VideoWork } from "./video-work";

const PACKET: VideoPacket = { codec: "h264", isKey: true, width: 64, height: 64, data: new Uint8Array(1) };

let asked: unknown[];
let port: Port;

beforeEach(() => {
  asked = [];
  port = { postMessage: (work: unknown) => void asked.push(work), terminate: () => {}, onmessage: null, onerror: null };
});

it("what was asked of a worker that breaks is refused, and so is what is asked of it later", async () => {
  const work = new VideoWork(port);
  const waiting = work.decode(PACKET);
  port.onerror?.call(port as Worker, { type: "error" } as ErrorEvent);
  await expect(waiting).rejects.toThrow("got error");
  await expect(work.decode(PACKET)).rejects.toThrow("got error");
  expect(asked).toHaveLength(1);
});

it("answers go to who asked, whatever their order", async () => {
  const work = new VideoWork(port);
  const pictures = [work.decode(PACKET), work.decode(PACKET)];
  for (const id of [2, 1]) {
    port.onmessage?.call(port as Worker, { data: { id, picture: `picture ${id}` } } as unknown as MessageEvent);
  }
  expect(await Promise.all(pictures)).toEqual(["picture 1", "picture 2"]);
});
