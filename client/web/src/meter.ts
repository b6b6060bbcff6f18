/** Speed and exactness: the balance to drag or pin, and, while it is open, what comes of it. */

import type { Frame } from "@culet/protocol/frame";
import type { Balance } from "@culet/protocol/messages";
import { type Controller, GUI } from "lil-gui";
import "./meter.css";
import { askedRate, type BalanceShown, balanceText, settingsText } from "./balance";
import { type Arrival, FrameHistory } from "./frame-history";
import type { Plots } from "./plots";
import { INITIAL, type ViewState } from "./view-state";

const WIDTH = 330;
const MARGIN = 12;
/** Between two drawings of the plots. */
const DRAW_MS = 100;

export class Meter {
  private readonly gui: GUI;
  private readonly shown: BalanceShown = { exactness: INITIAL.exactness, pinned: INITIAL.pinned };
  private state: BalanceShown = INITIAL;
  private readonly exactness: Controller;
  private readonly pinned: Controller;
  private readonly meaning = paragraph();
  private readonly settings = paragraph();
  private readonly figures = document.createElement("div");
  private readonly history = new FrameHistory();
  private readonly send: (balance: Balance) => void;
  private latest: Frame | null = null;
  private plots: Plots | null = null;
  private open = false;
  /** The slider is being dragged: it shows where the finger is, not what the server last said. */
  private held = false;
  /** Sent with the next animation frame. */
  private wanted: BalanceShown | null = null;
  private drawing: ReturnType<typeof setTimeout> | undefined;

  constructor(container: HTMLElement, send: (balance: Balance) => void) {
    this.send = send;
    this.gui = new GUI({ container, title: "Speed and exactness", injectStyles: false, width: WIDTH }).close();
    this.exactness = this.gui.add(this.shown, "exactness", 0, 1, 0.05).name("Exactness");
    this.exactness.domElement.title = "0: many frames a second; 1: few and good ones. For all viewers of this session";
    this.exactness.onChange(() => this.ask(true)).onFinishChange(() => this.release());
    this.pinned = this.gui.add(this.shown, "pinned").name("Pin the quality");
    this.pinned.domElement.title = "Moving frames keep this quality, however long they take";
    this.pinned.onChange(() => this.ask(false));
    this.figures.className = "figures";
    this.gui.$children.append(this.meaning, this.settings, this.figures);
    this.gui.onOpenClose(() => this.fold());
    window.addEventListener("resize", () => this.plots?.resize(this.width));
    this.display();
  }

  update({ exactness, pinned }: ViewState): void {
    this.state = { exactness, pinned };
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

  private ask(held: boolean): void {
    this.held = held;
    const first = this.wanted === null;
    this.wanted = { ...this.shown };
    if (first) requestAnimationFrame(() => this.flush());
  }

  private flush(): void {
    if (this.wanted) this.send({ type: "balance", ...this.wanted });
    this.wanted = null;
    this.display(); // what is not held shows what is, until the server says that it changed
  }

  private release(): void {
    this.held = false;
  }

  private display(): void {
    if (!this.held) this.shown.exactness = this.state.exactness;
    this.shown.pinned = this.state.pinned;
    this.exactness.updateDisplay();
    this.pinned.updateDisplay();
    this.meaning.textContent = balanceText({ ...this.shown });
  }
}

function paragraph(): HTMLParagraphElement {
  const made = document.createElement("p");
  made.className = "meter-words";
  return made;
}
