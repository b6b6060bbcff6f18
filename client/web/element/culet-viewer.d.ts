/** `<culet-viewer>`. Attributes: `src`, `preset`, `watch`, `rotate`, `background`, `poster`, `alt`. Events: `load` (the live picture is shown), `error` (its `message` says why there is none). */
export declare class CuletViewer extends HTMLElement {}

declare global {
  interface HTMLElementTagNameMap {
    "culet-viewer": CuletViewer;
  }
}
