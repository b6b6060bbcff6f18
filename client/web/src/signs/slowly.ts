/** Telling of what goes on only where it takes a while: what is done at once is no news. */

const SOON_MS = 600;

/** `tell` after a while, unless what is returned is called before; what `tell` returns is called by it then. */
export function slowly(tell: () => () => void): () => void {
  let end: (() => void) | null = null;
  const timer = setTimeout(() => {
    end = tell();
  }, SOON_MS);
  return () => {
    clearTimeout(timer);
    end?.();
  };
}
