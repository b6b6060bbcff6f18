/** The picture on the screen: which of those that come is put there, and of how many pixels the next ones are asked for. */

import { Flag, type Frame } from "@culet/protocol/frame";
import { isWorse, type Judged, refines } from "./fade";

/** Of the screen. */
export interface Canvas<Picture> {
  show: (picture: Picture, refines: boolean) => void;
  /** Ask for all pixels that the screen has. */
  sharpen: () => void;
  /** Ask for no more than come quickly. */
  hurry: () => void;
}

export class ShownPicture<Picture extends { close: () => void }> {
  private readonly screen: Canvas<Picture>;
  private shown: Judged | null = null;

  constructor(screen: Canvas<Picture>) {
    this.screen = screen;
  }

  /** Put it on the screen, or close it if it is worse than what is there; whether it is shown. */
  show(picture: Picture, frame: Pick<Frame, keyof Judged>): boolean {
    const { shown } = this;
    if (isWorse(frame, shown)) {
      picture.close();
      return false;
    }
    this.screen.show(picture, refines(frame, shown?.step ?? null));
    this.shown = frame;
    // A link that does not carry all of this picture would carry less of a larger one.
    if (frame.flags & Flag.FINAL && !(frame.flags & Flag.THRIFTY)) this.screen.sharpen();
    // A picture of more pixels keeps its state's number: another number is another view, or another scene.
    else if (frame.flags & Flag.MOVING || frame.step !== shown?.step) this.screen.hurry();
    return true;
  }
}
