import { Flag } from "@culet/protocol/frame";
import { expect, test, vi } from "vitest";
import { ShownPicture } from "./shown-picture";

const QUICK = { width: 1920, height: 1080 };
const SHARP = { width: 3840, height: 2160 };
const frame = (step: bigint, flags = 0, size = QUICK, shownError = 0.004) => ({ step, flags, ...size, shownError });

function shownPicture() {
  const asked: string[] = [];
  const screen = { show: vi.fn(), sharpen: () => asked.push("sharp"), hurry: () => asked.push("quick") };
  const shown = new ShownPicture(screen);
  const take = (...of: Parameters<typeof frame>) => {
    const picture = { close: vi.fn() };
    return { seen: shown.show(picture, frame(...of)), picture };
  };
  return { screen, asked, take };
}

test("a finished picture is followed by one of all pixels, and that by no other request while the view stays", () => {
  const { asked, take } = shownPicture();
  take(1n);
  take(1n, Flag.FINAL);
  expect(asked).toEqual(["quick", "sharp"]);
  take(1n, 0, SHARP, 0.007);
  take(1n, 0, SHARP, 0.005);
  expect(asked).toEqual(["quick", "sharp"]);
});

test("another view asks for quick pictures again, though no stone moves", () => {
  const { asked, take } = shownPicture();
  take(1n, Flag.FINAL);
  take(1n, Flag.FINAL, SHARP);
  asked.length = 0;
  take(2n, 0, SHARP, 0.02);
  expect(asked).toEqual(["quick"]);
});

test("stones that move ask for quick pictures", () => {
  const { asked, take } = shownPicture();
  take(1n);
  asked.length = 0;
  take(1n, Flag.MOVING);
  expect(asked).toEqual(["quick"]);
});

test("no more pixels are asked for over a link that does not carry those of a finished picture", () => {
  const { asked, take } = shownPicture();
  take(1n);
  take(1n, Flag.FINAL | Flag.THRIFTY);
  expect(asked).toEqual(["quick"]);
});

test("a picture that is withheld is closed, not shown, and said not to be seen", () => {
  const { screen, take } = shownPicture();
  expect(take(1n, Flag.FINAL).seen).toBe(true);
  const { seen, picture } = take(1n, 0, SHARP, 0.02);
  expect(seen).toBe(false);
  expect(picture.close).toHaveBeenCalledOnce();
  expect(screen.show).toHaveBeenCalledOnce();
});
