/** `<culet-viewer>`. Attributes: `src`, `preset`, `watch`, `rotate`, `poster`, `alt`. Events: `load` (the live picture is shown), `error`. */
export declare class CuletViewer extends HTMLElement {}

declare global {
  interface HTMLElementTagNameMap {
    "culet-viewer": CuletViewer;
  }
}
