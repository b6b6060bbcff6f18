/** The panel's table of the stone's grades. Asked for while its section is open, and anew when the stone changes. */

import type { JsonObject } from "@culet/protocol/messages";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { text } from "../json";
import type { ViewState } from "../session/view-state";
import { stoneOf } from "../stones/stones";
import { words } from "../words/words";
import { type GradeLine, gradedBy, reportOf } from "./grades";
import { Grading } from "./grading";
import type { TiltPlot } from "./tilt-plot";

/** The server's answer for a stone; `signal` gives up on it. */
export type Ask = (stone: string, tilt: boolean, signal: AbortSignal) => Promise<JsonObject>;

/** Answers that are remembered: two are compared. */
const MOST_KNOWN = 8;

export class GradePanel {
  private readonly section: Section;
  /** The stone's size, or why it is not graded. */
  private readonly status = document.createElement("p");
  private readonly table = document.createElement("table");
  private readonly plot = document.createElement("div");
  private readonly tilt: Command;
  private readonly grading: Grading;
  private scene: ViewState["scene"] = null;
  /** The scene as the design would have it that this one is compared with. */
  private readonly otherwise: (scene: ViewState["scene"]) => ViewState["scene"];
  /** The last answers, by what they depend on. */
  private readonly known = new Map<string, JsonObject>();
  private curves: TiltPlot | null = null;

  constructor(section: Section, ask: Ask, otherwise: (scene: ViewState["scene"]) => ViewState["scene"]) {
    this.otherwise = otherwise;
    this.section = section.show(false);
    this.grading = new Grading({
      ask: (tilt, signal) => ask(text(stoneOf(this.scene).id, ""), tilt, signal),
      seen: () => section.open,
      busy: (on) => this.wait(on),
      outdated: () => this.table.classList.add("outdated"),
      show: (answer, signal) => this.show(answer, signal),
      fail: (why) => this.fail(why),
    });
    this.status.className = "grade-size";
    this.status.setAttribute("role", "status");
    this.table.className = "grades";
    this.table.createTBody();
    this.plot.className = "tilt-plot";
    for (const element of [this.status, this.table]) section.add({ element });
    this.tilt = section.add(new Command(words.grades.tilt, () => this.grading.request(true)));
    section.add({ element: this.plot });
    section.onFold((open) => open && this.grading.reopened(gradedBy(this.scene)));
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    const stone = gradedBy(scene);
    this.section.show(stone !== "");
    if (this.section.open) this.grading.refresh(stone);
  }

  /** Whether an answer is waited for; what is shown of the stone before stays meanwhile. */
  private wait(on: boolean): void {
    this.tilt.busy(on);
    if (on && !this.status.textContent) this.status.textContent = words.grades.waits;
  }

  private async show(answer: JsonObject, signal: AbortSignal): Promise<void> {
    this.remember(answer);
    const other = this.known.get(gradedBy(this.otherwise(this.scene)));
    const { size, lines, tilt } = reportOf(answer, other ?? null);
    const plots = tilt && (await import("./tilt-plot"));
    if (signal.aborted) return;
    this.clear(size);
    this.table.tBodies[0]?.append(...lines.map(rowOf));
    if (plots) this.curves = plots.plotTilt(this.plot, tilt, this.section.body.clientWidth - 16);
  }

  private remember(answer: JsonObject): void {
    const stone = gradedBy(this.scene);
    this.known.delete(stone);
    this.known.set(stone, answer);
    const [oldest] = this.known.keys();
    if (this.known.size > MOST_KNOWN && oldest !== undefined) this.known.delete(oldest);
  }

  private fail(why: string): void {
    this.clear(why);
  }

  /** Leave nothing but what is said of the stone as it is. */
  private clear(said: string): void {
    if (this.status.textContent !== said) this.status.textContent = said; // or a retry would be read out as news
    this.table.classList.remove("outdated");
    this.table.tBodies[0]?.replaceChildren();
    this.curves?.destroy();
    this.curves = null;
    this.plot.replaceChildren();
  }
}

function rowOf({ name, value, error, difference, hint }: GradeLine): HTMLTableRowElement {
  const row = document.createElement("tr");
  const head = document.createElement("th");
  head.scope = "row";
  head.textContent = name;
  row.append(head);
  row.insertCell().textContent = value;
  row.insertCell().textContent = error;
  if (difference !== null) row.insertCell().textContent = difference;
  row.dataset.hint = row.ariaDescription = difference === null ? hint : words.grades.differenceHint(hint);
  return row;
}
