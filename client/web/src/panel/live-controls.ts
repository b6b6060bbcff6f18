/** Sliders and lists that act while a finger is on them, once a picture at most, and otherwise show what is. */

import type { Control } from "../controls/control";

/**
 * For so long after it was let go, a slider or list stays where it is: what the server says of it may still be on its way,
 * and the next arrow key of a list goes on from there.
 */
const ECHO_MS = 500;

export class LiveControls<T extends object> {
  /** What the controls show. */
  readonly shown: T;
  private readonly controls = new Map<keyof T, Control<T[keyof T]>>();
  /** Show where the finger is or was, not what the server last said; with the timer that ends this, if let go. */
  private readonly held = new Map<keyof T, ReturnType<typeof setTimeout> | undefined>();
  private readonly waiting = new Map<keyof T, T[keyof T]>();
  private readonly now: () => T;
  private readonly send: (name: keyof T, value: T[keyof T]) => void;
  private readonly done: (() => Promise<void>) | null;
  /** What was sent is not done. */
  private unanswered = false;

  /**
   * `now` says what the server last said, `send` asks it for another value. `done` ends when the server is done with what
   * was sent: where that takes it long, nothing is sent until then, and the newest values after it.
   */
  constructor(
    now: () => T,
    send: (name: keyof T, value: T[keyof T]) => void,
    done: (() => Promise<void>) | null = null,
  ) {
    this.now = now;
    this.send = send;
    this.done = done;
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
    while (this.waiting.size > 0) {
      for (const [name, value] of this.waiting) this.send(name, value);
      this.waiting.clear();
      if (!this.done) return;
      this.unanswered = true;
      await this.done();
      this.unanswered = false;
    }
  }
}
