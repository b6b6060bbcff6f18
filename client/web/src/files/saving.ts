/** Pictures, scenes and links that leave the page: all are of what was seen when they were asked for. */

import type { JsonObject } from "@culet/protocol/messages";
import * as rest from "../session/rest";
import { words } from "../words/words";
import { copyPicture, copyText } from "./clipboard";
import { download } from "./files";
import { viewAddress } from "./view-link";

/** The frame that is seen, and of which session. */
export interface SeenFrame {
  session: string;
  step: bigint;
  /** Pixels. */
  width: number;
  height: number;
}

export interface SavedWorld {
  /** Null before there is a picture. */
  seen: () => SeenFrame | null;
  scene: () => JsonObject | null;
  /** Tell the user something that passes. */
  note: (text: string) => void;
  /** Tell the user what goes on, until what is returned is called. */
  notice: (text: string) => () => void;
}

/** What a picture may be saved as, in the panel's order, with what the format and the button are called. */
export const FORMATS: readonly (readonly [rest.Format, string, string])[] = [
  ["webp", "WebP", words.panel.saveWebp],
  ["tga", "TGA", words.panel.saveTga],
  ["exr", "EXR", words.panel.saveExr],
];

export class Saving {
  private readonly world: SavedWorld;

  constructor(world: SavedWorld) {
    this.world = world;
  }

  /** A file of the frame that is seen, rendered anew; throws Error with words for the user. */
  async picture(format: rest.Format): Promise<void> {
    const { step } = this.seen();
    download(await this.rendered(format), `culet-${step}.${format}`);
  }

  /** The same picture to the clipboard, as PNG. */
  async copyPicture(): Promise<void> {
    await copyPicture(() => this.rendered("png"));
    this.world.note(words.files.pictureCopied);
  }

  /** A link that shows what is seen, also when this session is gone, to the clipboard. */
  async copyLink(): Promise<void> {
    const { session, step, width, height } = this.seen();
    await copyText(async () => {
      const scene = await rest.sceneShown(session, step);
      return viewAddress({ scene, aspect: width / height }, location.href);
    });
    this.world.note(words.files.linkCopied);
  }

  /** A file of the scene, with the stones where they start. */
  async scene(): Promise<void> {
    const scene = this.world.scene();
    if (!scene) throw new Error(words.files.noScene);
    download(new Blob([`${JSON.stringify(scene, null, 2)}\n`], { type: "application/json" }), "scene.json");
  }

  private async rendered(format: rest.Format): Promise<Blob> {
    const { session, step } = this.seen();
    const clear = this.world.notice(words.files.rendering);
    try {
      return await rest.picture(session, step, format);
    } finally {
      clear();
    }
  }

  private seen(): SeenFrame {
    const seen = this.world.seen();
    if (!seen) throw new Error(words.files.noPicture);
    return seen;
  }
}
