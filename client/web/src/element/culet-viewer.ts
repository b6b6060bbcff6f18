/** `<culet-viewer>`: a gem in any page. It shows a poster, and the live picture of a server over that once it has come. */

import type { Told } from "../picture/embedding";
import { viewer } from "../words/english";
import { frameAddress, posterAddress, type Wanted } from "./addresses";

const STYLE = `
  :host { display: block; position: relative; aspect-ratio: 4 / 3; overflow: hidden; contain: content; }
  :host([hidden]) { display: none; }
  img, iframe { position: absolute; inset: 0; width: 100%; height: 100%; border: 0; }
  img { object-fit: cover; }
  iframe { opacity: 0; }
  iframe.shown { opacity: 1; transition: opacity 0.3s; }
  @media (prefers-reduced-motion: reduce) { iframe.shown { transition: none; } }
`;

/** The server that this script came from. */
const HOME = new URL(/* @vite-ignore */ "..", import.meta.url).href;

/** ms for which the poster goes before the live picture: both are drawn by the same server. */
const PATIENCE_MS = 2000;

function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

export class CuletViewer extends HTMLElement {
  static readonly observedAttributes = ["src", "preset", "watch", "rotate", "background", "poster", "alt"];
  private readonly poster = document.createElement("img");
  private frame: HTMLIFrameElement | null = null;
  private origin = "";
  private near: IntersectionObserver | null = null;
  private shown: Wanted | null = null;
  private readonly heard = (event: MessageEvent) => this.hear(event);

  constructor() {
    super();
    const style = document.createElement("style");
    style.textContent = STYLE;
    // Without a poster, as where the server gives none to other sites, there is the page's own ground.
    this.poster.onerror = () => {
      this.poster.hidden = true;
    };
    this.poster.onload = () => {
      this.poster.hidden = false;
    };
    this.poster.hidden = true;
    this.attachShadow({ mode: "open" }).append(style, this.poster);
  }

  connectedCallback(): void {
    window.addEventListener("message", this.heard);
    this.begin();
  }

  disconnectedCallback(): void {
    window.removeEventListener("message", this.heard);
    this.end();
  }

  attributeChangedCallback(name: string, before: string | null, after: string | null): void {
    if (before === after || !this.isConnected) return;
    if (name === "alt") this.label();
    else this.begin();
  }

  /** The poster now; the live picture, which takes a session of the server, once the element comes into sight. */
  private begin(): void {
    this.end();
    this.label();
    const wanted = this.wanted();
    if (!wanted) return;
    const { width, height } = this.getBoundingClientRect();
    this.poster.src = this.getAttribute("poster") ?? posterAddress(wanted, width, height, devicePixelRatio);
    const poster = this.poster.decode().catch(() => undefined);
    this.near = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      this.near?.disconnect();
      void Promise.race([poster, pause(PATIENCE_MS)]).then(() => this.open(wanted));
    });
    this.shown = wanted;
    this.near.observe(this);
  }

  private end(): void {
    this.near?.disconnect();
    this.near = null;
    this.shown = null;
    this.frame?.remove();
    this.frame = null;
  }

  /** Unless something else is wanted by now. */
  private open(wanted: Wanted): void {
    if (this.shown !== wanted) return;
    const frame = document.createElement("iframe");
    frame.src = frameAddress(wanted);
    frame.title = this.words();
    frame.allow = "fullscreen";
    this.origin = new URL(frame.src).origin;
    this.frame = frame;
    this.shadowRoot?.append(frame);
  }

  private hear({ source, origin, data }: MessageEvent): void {
    if (!this.frame || source !== this.frame.contentWindow || origin !== this.origin) return;
    const told = data as Told | null;
    if (told?.culet === "shown") {
      this.frame.classList.add("shown");
      this.dispatchEvent(new Event("load"));
    }
    if (told?.culet === "obstacle") {
      // The page says itself what is in the way; while that may pass by itself the poster stays, if there is one.
      if (!told.passes || this.poster.hidden) this.frame.classList.add("shown");
      if (!told.passes) this.dispatchEvent(new ErrorEvent("error", { message: told.text }));
    }
  }

  /** What its attributes ask for; null, and an `error` event, if `src` is no address. */
  private wanted(): Wanted | null {
    const src = this.getAttribute("src") ?? HOME;
    try {
      const { href } = new URL(src, document.baseURI);
      const given = (name: string) => this.getAttribute(name);
      return {
        src: href,
        preset: given("preset"),
        watch: given("watch"),
        rotate: given("rotate"),
        background: given("background"),
      };
    } catch {
      this.dispatchEvent(new ErrorEvent("error", { message: viewer.noAddress(src) }));
      return null;
    }
  }

  private words(): string {
    return this.getAttribute("alt") ?? viewer.alt;
  }

  private label(): void {
    this.poster.alt = this.words();
    if (this.frame) this.frame.title = this.words();
  }
}

if (!customElements.get("culet-viewer")) customElements.define("culet-viewer", CuletViewer);

declare global {
  interface HTMLElementTagNameMap {
    "culet-viewer": CuletViewer;
  }
}
