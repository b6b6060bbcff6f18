/** What an action does: to the session, or to the page alone. */

import type { Clips } from "../clip/clips";
import type { Saving } from "../files/saving";
import type { SessionEvent, Target } from "../session/events";
import { inVain } from "../session/view-state";
import type { Visit } from "../session/visit";
import type { Complaints } from "../signs/complaints";
import type { StoneCommands } from "../stones/stone-commands";
import { words } from "../words/words";
import type { Action } from "./actions";
import { type Move, movesOf } from "./moves";

export interface PageCommands {
  showKeys: () => void;
  hideAll: () => void;
  /** Turn the mode on or off in which a click draws a ray. */
  traceRay: () => void;
  /** Show the other of two designs that are compared; keep the first one. */
  changeDesigns: () => void;
  /** Show both designs with a divider between them, or the one alone. */
  divide: () => void;
  /** Show all of a picture of another shape than the window, or fill the window with it. */
  fit: () => void;
  /** Something moves by hand. */
  moved: () => void;
  /** Tell the user something that passes. */
  note: (text: string) => void;
}

type Commanded = Pick<PageCommands, "showKeys" | "hideAll" | "traceRay" | "changeDesigns" | "divide" | "fit">;

export interface PerformingRooms {
  visit: Visit;
  stones: StoneCommands;
  saving: Saving;
  clips: Clips;
  page: PageCommands;
  complaints: Complaints;
}

export class Performing {
  private readonly visit: Visit;
  private readonly stones: StoneCommands;
  private readonly saving: Saving;
  private readonly clips: Clips;
  private readonly page: PageCommands;
  private readonly complaints: Complaints;

  constructor(rooms: PerformingRooms) {
    this.visit = rooms.visit;
    this.stones = rooms.stones;
    this.saving = rooms.saving;
    this.clips = rooms.clips;
    this.page = rooms.page;
    this.complaints = rooms.complaints;
  }

  perform({ effect }: Action): void {
    const { viewer } = this.visit;
    if (effect.kind === "download") this.complaints.attempt(() => this.saving.picture(effect.format));
    else if (effect.kind === "copy") this.complaints.attempt(() => this.copy(effect.what));
    else if (effect.kind === "clip") this.complaints.attempt(() => this.clip(effect.of));
    else if (effect.kind === "page") this.onPage(effect.command);
    else if (!viewer) this.complaints.tell(words.connection.noSessionYet);
    else if (effect.kind === "stones") this.stones[effect.command]();
    else if (effect.kind === "select") viewer.select(effect.target);
    else if (effect.kind === "move") this.move(effect.move, viewer.state.target);
    else this.send(effect.event);
  }

  /** Move the target: a stone only if it is known which. */
  move(by: Move, target: Target): void {
    this.page.moved();
    const stone = this.stones.chosen();
    if (target === "stone" && stone === null) this.complaints.tell(words.stones.chooseFirst);
    else for (const event of movesOf(by, target, stone ?? "")) this.visit.send(event);
  }

  private send(event: SessionEvent): void {
    const { viewer } = this.visit;
    const vain = !viewer || viewer.untold ? null : inVain(viewer.state, event);
    if (vain) this.page.note(vain);
    else this.visit.send(event);
  }

  private copy(what: "picture" | "link"): Promise<void> {
    return what === "picture" ? this.saving.copyPicture() : this.saving.copyLink();
  }

  private clip(of: "last" | "next"): Promise<void> {
    return of === "last" ? this.clips.last() : this.clips.record();
  }

  private onPage(command: keyof Commanded | "fillScreen"): void {
    if (command === "fillScreen") this.complaints.attempt(fillScreen);
    else this.page[command]();
  }
}

/** Or leave the full screen. */
function fillScreen(): Promise<void> {
  return document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen();
}
