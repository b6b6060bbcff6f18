/** What is opened in the page: scenes, meshes and skies from files, and scenes of the server's. */

import { imageSky } from "../panel/sky-choice";
import { framed } from "../picture/framing";
import type { Preset, Upload } from "../session/catalogue";
import type { SessionEvent } from "../session/events";
import type { OpenedFiles } from "../session/recovery";
import * as rest from "../session/rest";
import type { ViewState } from "../session/view-state";
import { reasonOf } from "../signs/complaints";
import type { Toasts } from "../signs/toasts";
import { stonePatch } from "../stones/stones";
import { words } from "../words/words";
import { parseScene } from "./files";

export interface OpeningWorld {
  state: () => ViewState;
  /** The id of the session; null while there is none. */
  session: () => string | null;
  send: (event: SessionEvent) => void;
  /** Of what the picture covers: width by height. */
  aspect: () => number;
  /** Another scene comes: what was remembered of the one before is not its. */
  forget: () => void;
  /** Offer a sky that was uploaded; the merge patch that chooses it. */
  offerSky: (sky: { name: string; title: string; summary: string }) => void;
  skyPatch: (sky: string) => Record<string, unknown>;
}

export class Opening {
  private readonly world: OpeningWorld;
  private readonly files: OpenedFiles;
  private readonly toasts: Toasts;

  constructor(world: OpeningWorld, files: OpenedFiles, toasts: Toasts) {
    this.world = world;
    this.files = files;
    this.toasts = toasts;
  }

  preset({ scene }: Preset): void {
    this.world.forget();
    this.world.send({ type: "set_scene", scene: framed(scene, this.world.aspect()) });
  }

  /** Throws Error with words for the user, as the others here do. */
  async scene(file: File): Promise<void> {
    const scene = parseScene(await file.text(), file.name);
    this.world.forget();
    this.world.send({ type: "set_scene", scene });
  }

  async mesh(file: File): Promise<void> {
    const mesh = await this.read(file, rest.uploadMesh);
    const { scene, stone } = this.world.state();
    this.toasts.finding(words.files.found(file.name, mesh.findings.join("\n")));
    const patch = stonePatch(scene, { mesh: mesh.id, recut: null }, stone ?? undefined);
    this.world.send({ type: "patch_scene", patch });
  }

  async sky(file: File): Promise<void> {
    const sky = await this.read(file, rest.uploadSky);
    const summary = sky.findings.join("\n");
    this.toasts.finding(words.files.found(file.name, summary));
    this.world.offerSky({ name: sky.id, title: file.name, summary });
    this.world.send({ type: "patch_scene", patch: this.world.skyPatch(imageSky(sky.id)) });
  }

  /** Upload a file, with words about it for as long as that takes, and keep it; a refusal names the file. */
  private async read(file: File, upload: (session: string, file: File) => Promise<Upload>): Promise<Upload> {
    const session = this.world.session();
    if (session === null) throw new Error(words.connection.noSessionYet);
    const give = (again: File) => upload(session, again);
    const clear = this.toasts.notice(words.files.reading(file.name));
    try {
      const known = await give(file);
      this.files.keep(known.id, file, give);
      return known;
    } catch (error) {
      throw new Error(words.files.of(file.name, reasonOf(error)));
    } finally {
      clear();
    }
  }
}
