/** The words of index.html: elements name theirs by `data-words`, and labels for screen readers by `data-label`. */

import { words } from "./words";

export function fillPage(page: Document): void {
  page.documentElement.lang = words.language;
  for (const element of page.querySelectorAll<HTMLElement>("[data-words]")) {
    element.textContent = said(element.dataset.words);
  }
  for (const element of page.querySelectorAll<HTMLElement>("[data-label]")) {
    element.setAttribute("aria-label", said(element.dataset.label));
  }
}

function said(name = ""): string {
  const text = (words.page as Record<string, string>)[name];
  if (text === undefined) throw new Error(`expected one of ${Object.keys(words.page).join(", ")}, got ${name}`);
  return text;
}
