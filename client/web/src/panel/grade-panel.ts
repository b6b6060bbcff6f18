/** The panel's table of the stone's grades. Asked for while its section is open, and anew when the stone changes. */

import type { JsonObject } from "@culet/protocol/messages";
import { Command } from "../controls/command";
import type { Section } from "../controls/section";
import { text } from "../json";
import type { ViewState } from "../session/view-state";
import { stoneOf } from "../stones/stones";
import { words } from "../words/words";
import { gradedBy, type Report, reportOf } from "./grades";

/** ms without a change of the stone before its grades are asked for: a slider that is dragged changes it all the time. */
const PATIENCE_MS = 250;

/** The server's answer for a stone; `signal` gives up on it. */
export type Ask = (stone: string, tilt: boolean, signal: AbortSignal) => Promise<JsonObject>;

export class GradePanel {
  private readonly section: Section;
  private readonly ask: Ask;
  private readonly size = document.createElement("p");
  private readonly table = document.createElement("table");
  private readonly plot = document.createElement("div");
  private readonly tilt: Command;
  private scene: ViewState["scene"] = null;
  /** What the table is of, or will be. */
  private asked = "";
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private giveUp = new AbortController();

  constructor(section: Section, ask: Ask) {
    this.section = section.show(false);
    this.ask = ask;
    this.size.className = "grade-size";
    this.table.className = "grades";
    this.table.createTBody();
    this.plot.className = "tilt-plot";
    for (const element of [this.size, this.table]) section.add({ element });
    this.tilt = section.add(new Command(words.grades.tilt, () => this.request(true)));
    section.add({ element: this.plot });
    section.onFold((open) => open && this.refresh());
  }

  update({ scene }: ViewState): void {
    this.scene = scene;
    this.section.show(gradedBy(scene) !== "");
    if (this.section.open) this.refresh();
  }

  /** Ask, if the table is of another stone, once the stone stays as it is. */
  private refresh(): void {
    const now = gradedBy(this.scene);
    if (now === this.asked || now === "") return;
    this.asked = now;
    this.giveUp.abort();
    clearTimeout(this.waiting);
    this.table.classList.add("outdated");
    this.waiting = setTimeout(() => this.request(false), PATIENCE_MS);
  }

  private async request(tilt: boolean): Promise<void> {
    this.giveUp.abort();
    this.giveUp = new AbortController();
    const { signal } = this.giveUp;
    this.tilt.enable(false);
    try {
      const report = reportOf(await this.ask(text(stoneOf(this.scene).id, ""), tilt, signal));
      if (signal.aborted) return;
      this.show(report);
      if (report.tilt) {
        const { plotTilt } = await import("./tilt-plot");
        plotTilt(this.plot, report.tilt, this.section.body.clientWidth - 16);
      } else this.plot.replaceChildren();
    } catch (error) {
      if (signal.aborted) return;
      this.table.tBodies[0]?.replaceChildren();
      this.plot.replaceChildren();
      this.size.textContent = error instanceof Error ? error.message : String(error);
    } finally {
      if (!signal.aborted) this.tilt.enable(true);
    }
  }

  private show({ size, lines }: Report): void {
    this.size.textContent = size;
    this.table.classList.remove("outdated");
    this.table.tBodies[0]?.replaceChildren(
      ...lines.map(({ name, value, hint }) => {
        const row = document.createElement("tr");
        const head = document.createElement("th");
        head.scope = "row";
        head.textContent = name;
        row.append(head);
        row.insertCell().textContent = value;
        row.dataset.hint = hint;
        return row;
      }),
    );
  }
}
