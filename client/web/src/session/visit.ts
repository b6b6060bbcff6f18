/** The page's session: found by the address or made, watched, and made again if the server has lost it. */

import type { Frame } from "@culet/protocol/frame";
import { CloseCode, type Outlined, type Picked, type Problem, type Reached } from "@culet/protocol/messages";
import { fitted, LinkError, unpackedView } from "../files/view-link";
import { part } from "../json";
import type { Arrival } from "../meter/frame-history";
import { type Embedding, queryOf } from "../picture/embedding";
import { framingPatch } from "../picture/framing";
import type { PictureSize } from "../picture/picture-size";
import { obstacleText } from "../signs/banner";
import type { Complaints } from "../signs/complaints";
import type { Signs } from "../signs/signs";
import { words } from "../words/words";
import type { SessionEvent } from "./events";
import { type OpenedFiles, recover } from "./recovery";
import * as rest from "./rest";
import { sessionAddress, streamUrl, tokenIn, type WantedSession, wantedSession, watchedStreamUrl } from "./session-url";
import { type Connection, pauseBefore } from "./stream";
import { INITIAL, type ViewState } from "./view-state";
import { Viewer } from "./viewer";

export interface VisitWorld {
  /** Of the picture that is asked for. */
  size: () => PictureSize;
  /** Of what the picture covers: width by height. */
  aspect: () => number;
  show: (picture: ImageBitmap, frame: Frame, arrival: Arrival) => void;
  state: (before: ViewState, after: ViewState) => void;
  /** A question of this viewer is answered. */
  answer: (answer: Picked | Outlined | Reached) => void;
  /** Something was refused; whether who did it is told, and sends it again if it can be. */
  refused: (problem: Problem) => boolean;
  /** Something that a user did goes to the server. */
  sent: (event: SessionEvent) => void;
  /** Something went well that the user should know of. */
  tell: (text: string) => void;
}

export class Visit {
  session: string | null = null;
  viewer: Viewer | null = null;
  /** The session is looked at by its watch id. */
  only = false;
  private readonly world: VisitWorld;
  private readonly signs: Signs;
  private readonly complaints: Complaints;
  private readonly files: OpenedFiles;
  private readonly embedding: Embedding;

  constructor(world: VisitWorld, signs: Signs, complaints: Complaints, files: OpenedFiles, embedding: Embedding) {
    this.world = world;
    this.signs = signs;
    this.complaints = complaints;
    this.files = files;
    this.embedding = embedding;
  }

  get state(): ViewState {
    return this.viewer?.state ?? INITIAL;
  }

  get scene(): ViewState["scene"] {
    return this.state.scene;
  }

  get lastFrame(): Frame | null {
    return this.viewer?.lastFrame ?? null;
  }

  send(event: SessionEvent): void {
    this.viewer?.send(event);
    this.world.sent(event);
  }

  /** Leave for a new session. */
  startAnew(): void {
    location.assign(this.only ? "./" : `./?${queryOf(this.embedding).slice(1)}`);
  }

  /** Find or make the session; after `tries` that failed, since the server was not ready. */
  async start(tries = 0): Promise<void> {
    const wanted = wantedSession(location.search, location.hash);
    if (wanted.kind === "invalid") return this.signs.end(words.connection.noId(wanted.id));
    try {
      // At once if there is no token: what else the page asks for then stands behind this in the browser's queue.
      const token = tokenIn(location.hash);
      if (token !== null) await this.enter(token);
      this.watch(await this.sessionFor(wanted), wanted.kind === "watch");
      this.signs.clear();
    } catch (error) {
      if (error instanceof LinkError) return this.signs.end(error.message);
      const known = asProblem(error);
      if (wanted.kind === "view" && known.status === 422) {
        return this.signs.end(`${words.connection.viewRefused}\n${known.message}`);
      }
      if (known.status === 401) return this.signs.retry(words.connection.needsToken, () => location.reload());
      if (wanted.kind === "watch" && known.status === 404) {
        return this.later(words.connection.notThere, tries, (next) => this.start(next));
      }
      if (wanted.kind === "session" && known.status === 404) return this.signs.end(unknownSession());
      if (wanted.kind === "new" && known.status === 404) return this.signs.end(known.message); // no such preset
      if (rest.isPassing(known)) this.later(known.message, tries, (next) => this.start(next));
      else this.signs.retry(known.message, () => this.complaints.attempt(() => this.start()));
    }
  }

  /** The id of the session that is there, or of the one that is made. */
  private async sessionFor(wanted: Exclude<WantedSession, { kind: "invalid" }>): Promise<string> {
    switch (wanted.kind) {
      case "session":
      case "watch":
        await rest.findSession(wanted.id);
        return wanted.id;
      case "view": {
        const scene = fitted(await unpackedView(wanted.packed), this.world.aspect());
        const { background } = this.embedding;
        const film = background === null ? {} : { film: { ...part(scene, "film"), background } };
        return (await rest.createSession({ scene: { ...scene, ...film } })).id;
      }
      case "new":
        return this.newSession(wanted.preset);
    }
  }

  /** The id of a session that is made for this window. */
  private async newSession(preset: string | undefined): Promise<string> {
    const { id, scene } = await rest.createSession(preset === undefined ? {} : { preset });
    const framing = framingPatch(scene, this.world.aspect());
    const { background } = this.embedding;
    if (framing || background !== null) {
      await rest.patchSession(id, { ...framing, ...(background === null ? {} : { film: { background } }) });
    }
    return id;
  }

  /** With the token that the address has, which then is forgotten: whoever looks over a shoulder may not see it. */
  private async enter(token: string): Promise<void> {
    await rest.signIn(token);
    history.replaceState(null, "", location.pathname + location.search);
  }

  private watch(id: string, only: boolean): void {
    this.session = id;
    this.only = only;
    if (!only) history.replaceState(null, "", sessionAddress(id, this.embedding));
    this.signs.await();
    const viewer = new Viewer(
      only ? watchedStreamUrl(location.href) : streamUrl(location.href, id),
      {
        show: this.world.show,
        size: this.world.size,
        connection: (connection) => this.connected(connection),
        state: (before, after) => {
          this.world.state(before, after);
          this.signs.connected(viewer.stream.connection, after.engine);
          if (before.leaving === null && after.leaving !== null) this.warn(after.leaving);
        },
        answer: this.world.answer,
        lacking: () => this.complaints.attempt(() => this.giveFilesAgain()),
        refused: this.world.refused,
        problem: (text, about) => this.complaints.tell(text, about),
      },
      only ? id : null,
    );
    this.viewer = viewer;
    viewer.stream.open();
    if (only && this.embedding.rotate === 0) this.world.tell(words.connection.watching);
  }

  private connected(connection: Connection): void {
    this.signs.connected(connection, this.state.engine);
    const { session, viewer } = this;
    if (connection.status === "closed") {
      const lost = connection.code === CloseCode.UNKNOWN_SESSION && session && !viewer?.ended;
      if (lost) this.complaints.attempt(() => this.regain());
      else this.signs.end(obstacleText(connection.code, connection.reason));
    }
    // A gateway that was restarted may not know the session any more, and a proxy may hide its close code.
    if (connection.status === "waiting" && session) void this.leaveIfUnknown(session);
  }

  /** The server is stopped in so many seconds at most. */
  private warn(seconds: number): void {
    this.complaints.tell(words.connection.leaving(Math.max(1, Math.ceil(seconds / 60))));
  }

  /** The server does not know the session any more: have it made again as this page last saw it. */
  private async regain(tries = 0): Promise<void> {
    if (this.only) return this.start(); // which waits until it is there again
    const { viewer, session, scene } = this;
    if (!viewer || !session || !scene) return this.signs.end(unknownSession());
    try {
      const lost = { id: session, scene, snapshot: viewer.snapshot };
      const here = await recover(lost, this.files, { reopen: rest.reopenSession, find: rest.findSession });
      this.signs.clear();
      viewer.stream.open();
      if (here) this.world.tell(words.connection.regained);
    } catch (error) {
      const known = asProblem(error);
      const passing = known.status === 404 ? words.connection.notThere : rest.isPassing(known) && known.message;
      if (passing) this.later(passing, tries, (next) => this.regain(next));
      else this.signs.end(`${words.connection.notRegained}\n${known.message}`);
    }
  }

  /** The render process was replaced, and lacks files that the server has not got any more. */
  private async giveFilesAgain(): Promise<void> {
    const { session, scene } = this;
    if (session && scene && (await this.files.giveAgain(scene))) await rest.patchSession(session, {});
  }

  private async leaveIfUnknown(id: string): Promise<void> {
    try {
      await rest.findSession(id);
    } catch (error) {
      if (error instanceof rest.ProblemError && error.status === 404) {
        this.viewer?.stream.close(CloseCode.UNKNOWN_SESSION, error.message);
      }
    }
  }

  /** Try again after a pause, or at once if the user wants to. */
  private later(why: string, tries: number, work: (tries: number) => Promise<void>): void {
    const again = () => {
      clearTimeout(timer);
      this.complaints.attempt(() => work(tries + 1));
    };
    const delay = pauseBefore(tries);
    const timer = setTimeout(again, delay);
    this.signs.retryAfter(why, delay, again);
  }
}

function unknownSession(): string {
  return obstacleText(CloseCode.UNKNOWN_SESSION, "");
}

function asProblem(error: unknown): rest.ProblemError {
  return error instanceof rest.ProblemError ? error : new rest.ProblemError(500, String(error));
}
