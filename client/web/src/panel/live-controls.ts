/** Sliders and lists that act while a finger is on them, once a picture at most, and otherwise show what is. */

import type { Control } from "../controls/control";
import type { Steps } from "./steps";

/**
 * For so long after it was let go, a slider or list stays where it is: what the server says of it may still be on its way,
 * and the next arrow key of a list goes on from there.
 */
const ECHO_MS = 500;

/** What a server gave up is sent again, so often and after such pauses: a minute of steps that take it 9 s each. */
const MOST_TRIES = 6;
const PAUSE_MS = 1000;

export class LiveControls<T extends object> {
  /** What the controls show. */
  readonly shown: T;
  private readonly controls = new Map<keyof T, Control<T[keyof T]>>();
  /** Show where the finger is or was, not what the server last said; with the timer that ends this, if let go. */
  private readonly held = new Map<keyof T, ReturnType<typeof setTimeout> | undefined>();
  private readonly waiting = new Map<keyof T, T[keyof T]>();
  private readonly now: () => T;
  private readonly send: (name: keyof T, value: T[keyof T]) => void;
  private readonly steps: Steps | null;
  /** What was sent is not done. */
  private unanswered = false;
  /** How often what waited was forgotten. */
  private forgotten = 0;

  /**
   * `now` says what the server last said, `send` asks it for another value. With `steps` nothing is sent until the server
   * is done with what was sent before, and the newest values then; what it gave up is sent again, unless there are newer.
   */
  constructor(now: () => T, send: (name: keyof T, value: T[keyof T]) => void, steps: Steps | null = null) {
    this.now = now;
    this.send = send;
    this.steps = steps;
    this.shown = { ...now() };
  }

  /** Let a control show and change the value of that name. */
  listen<K extends keyof T>(name: K, control: Control<T[K]>): void {
    this.controls.set(name, control as unknown as Control<T[keyof T]>);
    control.value = this.shown[name];
    control.onInput((value) => {
      this.hold(name);
      this.shown[name] = value;
      this.display(); // what is not held shows what is, until the server says that it changed
      if (this.waiting.size === 0) requestAnimationFrame(() => void this.flush());
      this.waiting.set(name, value);
    });
    control.onSettled(() => this.letGo(name));
  }

  display(): void {
    const now = this.now();
    for (const name of this.held.keys()) now[name] = this.shown[name];
    Object.assign(this.shown, now);
    for (const [name, control] of this.controls) control.value = this.shown[name];
  }

  /** Send nothing of what waits: something else has been done that ends it. */
  forget(): void {
    this.waiting.clear();
    this.forgotten += 1;
  }

  private hold(name: keyof T, timer?: ReturnType<typeof setTimeout>): void {
    clearTimeout(this.held.get(name));
    this.held.set(name, timer);
  }

  private letGo(name: keyof T): void {
    if (!this.held.has(name)) return;
    const end = () => {
      if (this.unanswered) return this.letGo(name); // what the server says is not about this value
      this.held.delete(name);
      this.display();
    };
    this.hold(name, setTimeout(end, ECHO_MS));
  }

  /** Send what waits, and once that is done what has come to wait meanwhile. */
  private async flush(): Promise<void> {
    if (this.unanswered) return;
    if (!this.steps) return this.sendAll(this.taken());
    this.unanswered = true;
    let tries = 0;
    while (this.waiting.size > 0) {
      const values = this.taken();
      const { forgotten } = this;
      const done = this.steps.working();
      const why = await this.steps.after(() => this.sendAll(values));
      tries = why === null ? 0 : tries + 1;
      if (why !== null && tries < MOST_TRIES) await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
      done();
      if (why === null) continue;
      if ([...values.keys()].every((name) => this.waiting.has(name))) tries = 0;
      else if (tries < MOST_TRIES && forgotten === this.forgotten) this.waitAgain(values);
      else this.steps.failed(why);
    }
    this.unanswered = false;
  }

  private taken(): Map<keyof T, T[keyof T]> {
    const values = new Map(this.waiting);
    this.waiting.clear();
    return values;
  }

  private sendAll(values: ReadonlyMap<keyof T, T[keyof T]>): void {
    for (const [name, value] of values) this.send(name, value);
  }

  /** Those of which there is no newer one. */
  private waitAgain(values: ReadonlyMap<keyof T, T[keyof T]>): void {
    for (const [name, value] of values) if (!this.waiting.has(name)) this.waiting.set(name, value);
  }
}
