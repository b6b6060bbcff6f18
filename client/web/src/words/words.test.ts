import { readdirSync, readFileSync } from "node:fs";
import { describe, expect, it, test } from "vitest";
import { strayWords } from "../testing/stray-words";
import * as english from "./english";

const SOURCES = new URL("../", import.meta.url);
const PAGE = readFileSync(new URL("../../index.html", import.meta.url), "utf8");

const modules = readdirSync(SOURCES, { recursive: true, encoding: "utf8" }).filter((name) => {
  return name.endsWith(".ts") && !name.endsWith(".test.ts") && !/^(words\/english|testing\/)/.test(name);
});

test.each(modules)("%s has no words of its own", (name) => {
  expect(strayWords(readFileSync(new URL(name, SOURCES), "utf8"))).toEqual([]);
});

describe("words are found", () => {
  it.each([
    ['button.textContent = "ok";', "ok"],
    ['box.title = known ? "one" : name;', "one"],
    ['box.setAttribute("aria-label", "Dismiss");', "Dismiss"],
    ['box.ariaLabel = "at " + place;', "at "],
    ["box.placeholder = `name`;", "name"],
    ['section.add(new Toggle("mirror"));', "mirror"],
    ['const option = { label: "light", value: "light" };', "light"],
    ['toasts.note("done");', "done"],
    ['throw new Error("There is no scene.");', "There is no scene."],
    // biome-ignore lint/suspicious/noTemplateCurlyInString: it is source text
    ["say(`Failed: ${why} is not here.`);", "Failed: {} is not here."],
    ['const WAITING = "Waiting\\u2026";', "Waiting\u2026"],
  ])("in %s", (source, found) => {
    expect(strayWords(source)).toContain(found);
  });

  it.each([
    'if (key === "ArrowLeft") go("left");',
    'box.setAttribute("role", "alert");',
    "box.title = words.panel.title;",
    'const kind: "light" | "half" = "light";',
    'box.textContent = "2\\u00d73";',
    'import { words } from "./words/words";',
  ])("but not in %s", (source) => {
    expect(strayWords(source)).toEqual([]);
  });
});

/** Attributes and texts of index.html. */
const ATTRIBUTE = /\b(aria-label|aria-description|title|placeholder|alt)="/;
const TEXT = />\s*([^<>]*\p{L}[^<>]*)</u;

it("index.html has no words but those for browsers without scripts", () => {
  const body = PAGE.slice(PAGE.indexOf("<body>")).replace(/<noscript>.*?<\/noscript>|<!--.*?-->/gs, "");
  expect(ATTRIBUTE.exec(body)).toBeNull();
  expect(TEXT.exec(body)).toBeNull();
  expect(TEXT.exec("<p>a word</p>")?.[1]).toBe("a word");
});

it("every word that index.html names is in the catalogue, and the other way round", () => {
  const named = [...PAGE.matchAll(/data-(?:words|label)="(\w+)"/g)].map(([, name]) => name);
  expect(new Set(named)).toEqual(new Set(Object.keys(english.page)));
});
