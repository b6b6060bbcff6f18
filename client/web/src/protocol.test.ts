import { Codec, Flag, FrameError, HEADER_SIZE, parseFrame } from "@culet/protocol/frame";
import type { ControlEvent } from "@culet/protocol/messages";
import { NoticeError, parseNotice } from "@culet/protocol/notice";
import { describe, expect, it, test } from "vitest";
import { bytes, frameCases, messages } from "./testing/fixtures";

const cases = Object.entries(frameCases());
const camel = (name: string) => name.replace(/_(\w)/g, (_, letter: string) => letter.toUpperCase());

describe("a golden frame", () => {
  it.each(cases.filter(([, { fields }]) => fields))("%s holds the listed fields", (_, { file, fields }) => {
    const { payload, step, ...rest } = parseFrame(bytes(file));
    const { payload: size, step: wantedStep, ...wanted } = fields ?? {};
    expect(payload.length).toBe(size);
    expect(step).toBe(BigInt(wantedStep ?? ""));
    expect(rest).toMatchObject(
      Object.fromEntries(Object.entries(wanted).map(([name, value]) => [camel(name), value ?? Number.NaN])),
    );
  });

  it.each(cases.filter(([, { expected }]) => expected))("%s is refused", (_, { file, expected, got }) => {
    expect(() => parseFrame(bytes(file))).toThrow(FrameError);
    expect(() => parseFrame(bytes(file))).toThrow(expected);
    expect(() => parseFrame(bytes(file))).toThrow(got);
  });

  test("keeps a step that a double cannot", () => {
    const { step, flags, codec } = parseFrame(bytes("png.bin"));
    expect(step).toBe(2n ** 53n + 1n);
    expect(flags & Flag.FINAL).toBeTruthy();
    expect(codec).toBe(Codec.PNG);
  });

  test("has its payload right behind the header", () => {
    const { payload } = parseFrame(bytes("jpeg.bin"));
    expect(payload.byteOffset).toBe(HEADER_SIZE);
    expect([...payload.subarray(0, 2)]).toEqual([0xff, 0xd8]); // JPEG's start of image
  });
});

describe("a notice", () => {
  it.each(messages().notices.map((notice) => [notice.type, notice]))("%s is read", (_, notice) => {
    expect(parseNotice(JSON.stringify(notice))).toEqual(notice);
  });

  it.each(Object.entries(messages().refused_notices))("is refused: %s", (_, text) => {
    expect(() => parseNotice(text)).toThrow(NoticeError);
  });

  it("of a type that is not known yet is ignored", () => {
    expect(parseNotice('{"type": "weather", "rain": true}')).toBeNull();
    expect(parseNotice('{"type": "constructor"}')).toBeNull();
  });

  it("may leave out what is optional", () => {
    expect(parseNotice('{"type": "problem", "code": "x", "message": "y"}')).toBeTruthy();
  });

  it("that is refused names the field", () => {
    expect(() => parseNotice('{"type": "engine", "status": "sideways"}')).toThrow(
      "engine.status: expected down or up, got string",
    );
  });
});

test("every control event has a TypeScript type", () => {
  // One of each, checked by the compiler; the fixtures say which types there are.
  const events: ControlEvent[] = [
    { type: "orbit", target: "camera", yaw: 0.25, pitch: -0.125 },
    { type: "translate", target: "light_1", right: 0.5, up: -0.5 },
    { type: "dolly", target: "light_2", forward: 0.5 },
    { type: "reset_camera" },
    { type: "look_at_stone" },
    { type: "look_at_stone", stone: "ruby" },
    { type: "toggle_fall" },
    { type: "toggle_fall", stone: "ruby" },
    { type: "reset_stone" },
    { type: "reset_stone", stone: "stone-2" },
    { type: "push", x: 0.25, y: -0.125, right: 0.5, up: 1.5 },
    { type: "move_stone", stone: "ruby", right: 0.25, up: -0.5, forward: 1 },
    { type: "drag_stone", stone: "ruby", right: 0.125, up: -0.25 },
    { type: "turn_stone", stone: "ruby", yaw: 0.25, pitch: -0.125, roll: 0.5 },
    { type: "toggle_mirror" },
    { type: "toggle_environment" },
    { type: "toggle_walls" },
    { type: "patch_scene", patch: { camera: { fov_degrees: 30 } } },
    { type: "set_scene", scene: {} },
    { type: "undo" },
    { type: "redo" },
    { type: "balance", exactness: 0.75, pinned: true },
    { type: "pick", number: 3, x: 0.25, y: -0.125 },
    { type: "outline", stone: "stone", step: 42 },
    { type: "reach", number: 4 },
    { type: "resize", width: 1280, height: 720 },
    { type: "visibility", visible: false },
    { type: "ack", sequence: 7 },
    { type: "decoders", codecs: ["h264", "vp9"] },
    { type: "ping", time: 1234.5 },
  ];
  expect(events).toEqual(messages().control_events);
});
