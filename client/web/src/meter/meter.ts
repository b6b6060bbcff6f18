/** Speed and exactness: the balance to drag or pin, and, while it is open, what comes of it. */

import type { Frame } from "@culet/protocol/frame";
import type { Balance } from "@culet/protocol/messages";
import "./meter.css";
import { Hints } from "../controls/hints";
import { Section } from "../controls/section";
import { type Clamped, Slider } from "../controls/slider";
import { Toggle } from "../controls/toggle";
import { LiveControls } from "../panel/live-controls";
import { INITIAL, type ViewState } from "../session/view-state";
import { words } from "../words/words";
import { askedRate, type BalanceShown, balanceText, settingsText } from "./balance";
import { DELAY_STAGES, type Delay } from "./delays";
import { type Arrival, FrameHistory } from "./frame-history";
import type { Plots } from "./plots";
import { milliseconds } from "./status-text";

const WIDTH = 330;
const MARGIN = 12;
const EXACTNESS = { least: 0, most: 1, step: 0.05, decimals: 2 };
/** Between two drawings of the plots. */
const DRAW_MS = 100;

export class Meter {
  private readonly section = new Section(words.meter.title, 2);
  private readonly controls: LiveControls<BalanceShown>;
  private state: BalanceShown = balanceOf(INITIAL);
  private readonly meaning = paragraph();
  private readonly settings = paragraph();
  private readonly delay = paragraph();
  private readonly figures = document.createElement("div");
  private readonly history = new FrameHistory();
  private readonly watched: (open: boolean) => void;
  private latest: Frame | null = null;
  private plots: Plots | null = null;
  private open = false;
  private drawing: ReturnType<typeof setTimeout> | undefined;

  constructor(
    container: HTMLElement,
    send: (balance: Balance) => void,
    watched: (open: boolean) => void,
    clamped: Clamped,
  ) {
    this.watched = watched;
    this.section.fold(true);
    this.controls = new LiveControls<BalanceShown>(
      () => ({ ...this.state }),
      (name, value) => send({ type: "balance", ...this.controls.shown, [name]: value }),
    );
    const exactness = this.section.add(new Slider(words.meter.exactness, EXACTNESS, clamped));
    const pinned = this.section.add(new Toggle(words.meter.pinned));
    this.controls.listen("exactness", exactness.hint(words.meter.exactnessHint));
    this.controls.listen("pinned", pinned.hint(words.meter.pinnedHint));
    this.figures.className = "figures";
    this.section.body.append(this.meaning, this.settings, this.delay, this.figures);
    this.section.onFold((open) => this.fold(open));
    this.section.element.append(new Hints(this.section.element).element);
    container.append(this.section.element);
    window.addEventListener("resize", () => this.plots?.resize(this.width));
    this.display();
  }

  update(state: ViewState): void {
    this.state = balanceOf(state);
    this.display();
  }

  /** A frame is on the screen. Folded, nothing is kept of it. */
  take(frame: Frame, arrival: Arrival): void {
    if (!this.open) return;
    this.latest = frame;
    this.history.push(frame, arrival);
    this.drawing ??= setTimeout(() => this.draw(), DRAW_MS);
  }

  /** An input is seen. */
  delayed(delay: Delay | null): void {
    if (this.open && delay) this.delay.textContent = delayText(delay);
  }

  private get width(): number {
    return Math.min(WIDTH, window.innerWidth) - MARGIN;
  }

  private fold(open: boolean): void {
    this.open = open;
    this.watched(open);
    if (!this.open) this.history.clear();
    else if (!this.plots) void this.load();
  }

  private async load(): Promise<void> {
    const { Plots } = await import("./plots");
    this.plots ??= new Plots(this.figures, this.history, this.width);
  }

  private draw(): void {
    this.drawing = undefined;
    if (this.latest) this.settings.textContent = settingsText(this.latest);
    const rate = askedRate(this.state);
    this.plots?.draw(rate === null ? null : 1000 / rate);
  }

  private display(): void {
    this.controls.display();
    this.meaning.textContent = balanceText(this.state);
  }
}

function balanceOf({ exactness, pinned }: BalanceShown): BalanceShown {
  return { exactness, pinned };
}

function delayText({ total, stages }: Delay): string {
  const { delay, delayStages } = words.meter;
  const parts = DELAY_STAGES.map((stage, index) => `${delayStages[stage]} ${milliseconds(stages[index] ?? 0)}`);
  return delay(milliseconds(total), parts.join(", "));
}

function paragraph(): HTMLParagraphElement {
  const made = document.createElement("p");
  made.className = "meter-words";
  return made;
}
