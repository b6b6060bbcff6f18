/** Speed and exactness: the balance to drag or pin, and, while it is open, what comes of it. */

import type { Frame } from "@culet/protocol/frame";
import type { Balance } from "@culet/protocol/messages";
import { GUI } from "lil-gui";
import "./meter.css";
import { askedRate, type BalanceShown, balanceText, settingsText } from "./balance";
import { type Arrival, FrameHistory } from "./frame-history";
import { LiveControls } from "./live-controls";
import type { Plots } from "./plots";
import { INITIAL, type ViewState } from "./view-state";

const WIDTH = 330;
const MARGIN = 12;
/** Between two drawings of the plots. */
const DRAW_MS = 100;

export class Meter {
  private readonly gui: GUI;
  private readonly controls: LiveControls<BalanceShown>;
  private state: BalanceShown = balanceOf(INITIAL);
  private readonly meaning = paragraph();
  private readonly settings = paragraph();
  private readonly figures = document.createElement("div");
  private readonly history = new FrameHistory();
  private latest: Frame | null = null;
  private plots: Plots | null = null;
  private open = false;
  private drawing: ReturnType<typeof setTimeout> | undefined;

  constructor(container: HTMLElement, send: (balance: Balance) => void) {
    this.gui = new GUI({ container, title: "Speed and exactness", injectStyles: false, width: WIDTH }).close();
    this.controls = new LiveControls<BalanceShown>(
      () => ({ ...this.state }),
      (name, value) => send({ type: "balance", ...this.controls.shown, [name]: value }),
    );
    const { shown } = this.controls;
    const exactness = this.gui.add(shown, "exactness", 0, 1, 0.05).name("Exactness");
    exactness.domElement.title = "0: many frames a second; 1: few and good ones. For all viewers of this session";
    const pinned = this.gui.add(shown, "pinned").name("Pin the quality");
    pinned.domElement.title = "Moving frames keep this quality, however long they take";
    this.controls.listen("exactness", exactness);
    this.controls.listen("pinned", pinned);
    this.figures.className = "figures";
    this.gui.$children.append(this.meaning, this.settings, this.figures);
    this.gui.onOpenClose(() => this.fold());
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

  private get width(): number {
    return Math.min(WIDTH, window.innerWidth) - MARGIN;
  }

  private fold(): void {
    this.open = !this.gui._closed;
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

function paragraph(): HTMLParagraphElement {
  const made = document.createElement("p");
  made.className = "meter-words";
  return made;
}
