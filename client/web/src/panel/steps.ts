/** What a control asks of a server that may take seconds for it: one step after the other, each until it is done. */
export interface Steps {
  /**
   * Do what sends something; ends when the server is done with that: with null, or why some of it was given up and can be
   * sent again.
   */
  after: (work: () => void) => Promise<string | null>;
  /** The server is at work; what is returned ends that. */
  working: () => () => void;
  /** It was given up for good. */
  failed: (why: string) => void;
}
