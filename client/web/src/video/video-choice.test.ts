import { Flag } from "@culet/protocol/frame";
import { afterEach, describe, expect, it, vi } from "vitest";
import { AGAIN_MS, NARROW_MS, savesData, VideoChoice } from "./video-choice";

type Seen = { flags: number; samples: number };

const FRAME_MS = 30;
const moving = { flags: Flag.MOVING, samples: 1 };
const thrifty = { flags: Flag.MOVING | Flag.THRIFTY, samples: 1 };
const resting = { flags: Flag.FINAL, samples: 16 };

/** Frames from `since` for so long; when the choice became another one, ms. */
function run(choice: VideoChoice, frame: Seen, waitsFor: "network" | "rendering", since: number, ms: number) {
  const changes: number[] = [];
  for (let time = since; time < since + ms; time += FRAME_MS)
    if (choice.shown(frame, time, waitsFor)) changes.push(time);
  return changes;
}

describe("the choice of video", () => {
  it("is pictures of their own as long as the way is wide enough for them", () => {
    const choice = new VideoChoice();
    expect(run(choice, moving, "rendering", 0, 10 * NARROW_MS)).toEqual([]);
    expect(choice.on).toBe(false);
  });

  it("is video once the way has been too narrow for a while", () => {
    const choice = new VideoChoice();
    const [changed] = run(choice, thrifty, "network", 1000, 10 * NARROW_MS);
    expect(changed).toBeGreaterThanOrEqual(1000 + NARROW_MS);
    expect(changed).toBeLessThan(1000 + NARROW_MS + 2 * FRAME_MS);
    expect(choice.on).toBe(true);
  });

  it("is video where the way carries hardly more than a frame a second", () => {
    const choice = new VideoChoice();
    for (let time = 0; time <= 3 * NARROW_MS; time += 900) choice.shown(thrifty, time, "network");
    expect(choice.on).toBe(true);
  });

  it("does not take the first moments of several motions for one narrow way", () => {
    const choice = new VideoChoice();
    for (let motion = 0; motion < 10; motion += 1) {
      const since = motion * 10 * NARROW_MS;
      expect(run(choice, thrifty, "network", since, NARROW_MS / 2)).toEqual([]);
      expect(run(choice, motion % 2 ? moving : resting, "rendering", since + NARROW_MS / 2, NARROW_MS / 2)).toEqual([]);
    }
    for (
      let motion = 20;
      motion < 30;
      motion += 1 // with nothing between them
    )
      expect(run(choice, thrifty, "network", motion * 10 * NARROW_MS, NARROW_MS / 2)).toEqual([]);
  });

  it("tries pictures of their own again at rest, if video has been as good as it gets for long", () => {
    const choice = new VideoChoice();
    run(choice, thrifty, "network", 0, 2 * NARROW_MS);
    expect(run(choice, resting, "network", 2 * NARROW_MS, NARROW_MS)).toEqual([]);
    expect(run(choice, moving, "rendering", 3 * NARROW_MS, AGAIN_MS)).toEqual([]); // not amid a motion
    expect(choice.on).toBe(true);
    const later = 4 * NARROW_MS + AGAIN_MS;
    expect(run(choice, resting, "rendering", later, FRAME_MS)).toEqual([later]);
    expect(choice.on).toBe(false);
  });

  it("stays video where even that is reduced for the sake of the link", () => {
    const choice = new VideoChoice();
    run(choice, thrifty, "network", 0, AGAIN_MS + 4 * NARROW_MS);
    expect(run(choice, resting, "network", AGAIN_MS + 4 * NARROW_MS, NARROW_MS)).toEqual([]);
    expect(choice.on).toBe(true);
  });

  it("is video from the first for who saves bytes, and stays so", () => {
    const choice = new VideoChoice(true);
    expect(choice.on).toBe(true);
    expect(run(choice, moving, "rendering", 0, NARROW_MS)).toEqual([]);
    expect(run(choice, resting, "rendering", 10 * AGAIN_MS, NARROW_MS)).toEqual([]);
  });
});

describe("saving of bytes", () => {
  afterEach(() => void vi.unstubAllGlobals());

  it("is what the browser's user asked for, where a browser tells", () => {
    for (const [connection, saves] of [
      [undefined, false],
      [{}, false],
      [{ saveData: true }, true],
    ] as const) {
      vi.stubGlobal("navigator", { connection });
      expect(savesData()).toBe(saves);
    }
  });
});
