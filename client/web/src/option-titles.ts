/** What the options of a list mean, as their tooltips. */

import type { Controller } from "lil-gui";
import type { Catalogued } from "./catalogue";

export function describeOptions(list: Controller, described: readonly Catalogued[]): void {
  const summaries = new Map(described.map(({ name, summary }) => [name, summary]));
  for (const option of list.domElement.querySelectorAll("option")) {
    option.title = summaries.get(option.text) ?? option.title;
  }
}
