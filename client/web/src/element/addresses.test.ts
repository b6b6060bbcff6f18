import { expect, it } from "vitest";
import { frameAddress, posterAddress } from "./addresses";

const WANTED = { src: "https://gems.example", preset: "ruby & co", watch: null, rotate: "20", background: null };

it("the live picture has no interface, and what was asked for", () => {
  expect(frameAddress(WANTED)).toBe("https://gems.example/?ui=0&preset=ruby+%26+co&rotate=20");
  expect(frameAddress({ ...WANTED, preset: null, rotate: null })).toBe("https://gems.example/?ui=0");
});

it("has the poster's background", () => {
  const wanted = { ...WANTED, background: "#f4f1ea" };
  expect(new URL(frameAddress(wanted)).searchParams.get("background")).toBe("f4f1ea");
  expect(new URL(posterAddress(wanted, 400, 300, 1)).searchParams.get("background")).toBe("f4f1ea");
});

it("a session that is only watched is shown as it is", () => {
  const watched = { ...WANTED, watch: "0123456789abcdef0123456789abcdef", rotate: null };
  expect(frameAddress(watched)).toBe(`https://gems.example/?ui=0&watch=${watched.watch}`);
  expect(posterAddress(watched, 400, 300, 1)).toBe(
    `https://gems.example/api/sessions/${watched.watch}/frame.webp?width=480&height=368`,
  );
});

it("of a server in a folder of a site is in that folder", () => {
  expect(
    frameAddress({ src: "https://shop.example/gems", preset: null, watch: null, rotate: null, background: null }),
  ).toBe("https://shop.example/gems/?ui=0");
  expect(posterAddress({ ...WANTED, src: "https://shop.example/gems/", preset: null }, 320, 320, 1)).toBe(
    "https://shop.example/gems/api/render.webp?width=320&height=320",
  );
});

it("a poster has one of a few sizes, of the area's shape", () => {
  expect(posterAddress(WANTED, 400, 300, 1)).toBe(
    "https://gems.example/api/render.webp?preset=ruby+%26+co&width=480&height=368",
  );
  const size = (width: number, height: number, ratio: number) => {
    const { searchParams } = new URL(posterAddress(WANTED, width, height, ratio));
    return [searchParams.get("width"), searchParams.get("height")].map(Number);
  };
  expect(size(300, 400, 2)).toEqual([720, 960]);
  expect(size(4000, 2000, 3)).toEqual([1280, 640]);
  expect(size(0, 0, 1)).toEqual([16, 16]);
});
