import { CloseCode, FINAL_CLOSE_CODES } from "@culet/protocol/messages";
import { describe, expect, it } from "vitest";
import { bannerText, obstacleText } from "./banner";

describe("the banner", () => {
  it("is silent while all is well", () => {
    expect(bannerText({ status: "open" }, "up")).toBeNull();
  });

  it("says that the engine is down although the connection stands", () => {
    expect(bannerText({ status: "open" }, "down")).toContain("render process stopped");
  });

  it("says in seconds when the next try is, never in 0", () => {
    expect(bannerText({ status: "waiting", delay: 4000 }, "up")).toContain("4 s");
    expect(bannerText({ status: "waiting", delay: 250 }, "up")).toContain("1 s");
  });
});

it("has its own words for each final close code that the server sends", () => {
  const words = FINAL_CLOSE_CODES.filter((code) => code !== CloseCode.NORMAL).map((code) => obstacleText(code, ""));
  expect(new Set(words).size).toBe(words.length);
  expect(words.filter((text) => /code \d/.test(text))).toEqual([]);
});

it("passes on the reason of a code that it does not know", () => {
  expect(obstacleText(4999, "too hot")).toContain("too hot");
  expect(obstacleText(4999, "")).toContain("4999");
});
