/** A WebSocket whose other end is the test. */

export class FakeSocket {
  /** All that were opened, oldest first. */
  static opened: FakeSocket[] = [];

  static get last(): FakeSocket {
    const socket = FakeSocket.opened.at(-1);
    if (!socket) throw new Error("expected a socket, but none was opened");
    return socket;
  }

  readonly sent: unknown[] = [];
  binaryType = "blob";
  closed = false;
  readonly url: string;
  readonly protocols: string[];
  onopen: ((event: Event) => void) | null = null;
  onmessage: ((event: MessageEvent) => void) | null = null;
  onclose: ((event: CloseEvent) => void) | null = null;

  constructor(url: string, protocols: string[]) {
    this.url = url;
    this.protocols = protocols;
    FakeSocket.opened.push(this);
  }

  send(text: string): void {
    this.sent.push(JSON.parse(text));
  }

  close(): void {
    this.closed = true;
  }

  accept(): void {
    this.onopen?.(new Event("open"));
  }

  say(data: string | ArrayBuffer | object): void {
    const sent = typeof data === "string" || data instanceof ArrayBuffer ? data : JSON.stringify(data);
    this.onmessage?.(new MessageEvent("message", { data: sent }));
  }

  drop(code: number, reason = ""): void {
    this.onclose?.(Object.assign(new Event("close"), { code, reason, wasClean: true }));
  }
}
