/** The page: finds or makes a session, then connects keys, fingers, panel and picture to it. */

import { CloseCode, type Outline, type Pick } from "@culet/protocol/messages";
import { type Action, actionNamed } from "./actions";
import {
  Banner,
  bannerText,
  NOT_REGAINED,
  Obstacle,
  obstacleText,
  REGAINED,
  tryingAgainText,
  WAITING,
  WAITING_LONG,
} from "./banner";
import { Bareness } from "./bareness";
import type { Preset, Upload } from "./catalogue";
import { ChosenStone } from "./chosen-stone";
import { type Embedding, embeddingOf, queryOf, SHOWN, Turntable } from "./embedding";
import type { SessionEvent, Target } from "./events";
import { refines } from "./fade";
import { FallButton } from "./fall-button";
import { listenToDrops } from "./file-drop";
import { chooseFile, MESH_TYPES, parseScene, SCENE_TYPES, SKY_TYPES } from "./files";
import { Findings } from "./findings";
import { framed, framingPatch } from "./framing";
import { placeOf } from "./gestures";
import { Hand } from "./hand";
import { KeyCard } from "./key-card";
import { listenToKeys } from "./keys";
import { Meter } from "./meter";
import { type Move, movesOf } from "./moves";
import { OutlineView } from "./outline-view";
import { element } from "./page";
import { Panel } from "./panel";
import { listenToPointers } from "./pointer-input";
import { expose, header } from "./probe";
import { OpenedFiles, recover } from "./recovery";
import * as rest from "./rest";
import { Saving } from "./saving";
import { SceneStrip } from "./scene-strip";
import { Screen } from "./screen";
import { sessionAddress, streamUrl, type Wanted, wantedSession } from "./session-url";
import { imageSky } from "./sky-choice";
import { ERROR_MEANINGS, statusText } from "./status-text";
import { CHOOSE_FIRST, StoneCommands } from "./stone-commands";
import { idsOf, stonePatch, stonesOf } from "./stones";
import { type Connection, pauseBefore } from "./stream";
import { Toasts } from "./toasts";
import { fitted, LinkError, unpackedView } from "./view-link";
import { describeChange, INITIAL, inVain, type ViewState } from "./view-state";
import { Viewer } from "./viewer";
import { Welcome } from "./welcome";
import { LOOK, Whereabouts } from "./whereabouts";
import { worded } from "./wording";

const canvas = element("picture", HTMLCanvasElement);
const banner = new Banner(element("banner", HTMLElement));
const unseen = new Banner(element("unseen", HTMLElement), element("unseen-text", HTMLElement));
const unseenButton = element("unseen-button", HTMLButtonElement);
unseenButton.onclick = () => viewer?.send({ type: "look_at_stone" });
const waiting = new Banner(element("waiting", HTMLElement));
const WAITING_LONG_MS = 1500;
const obstacle = new Obstacle(
  element("obstacle", HTMLElement),
  element("obstacle-text", HTMLElement),
  element("obstacle-button", HTMLButtonElement),
);
const toasts = new Toasts(element("toasts", HTMLElement));
const announcement = element("announcement", HTMLElement);
const statusLine = element("status", HTMLElement);
const PROBLEMS_KEPT = 100;
const VIEW_REFUSED = "This server cannot show the view of this link.";
/** What is left to do, beside moves, where a page shows nothing but the picture. */
const VIEWING = new Set(["reset_camera", "look", "full"]);
const COME_BACK = "H, Esc or a tap on the picture brings everything back.";
const problems: string[] = [];
const files = new OpenedFiles();
let session: string | null = null;
let viewer: Viewer | null = null;
/** Where the stones are, if the picture shows none of them. */
let elsewhere: string | null = null;

const outline = new OutlineView(element("outline", SVGSVGElement), canvas);
const chosen = new ChosenStone({
  ask: (question: Pick | Outline) => viewer?.ask(question),
  chosen: (id) => viewer?.choose(id),
  outline: (points) => {
    const frame = viewer?.lastFrame;
    if (points && frame) outline.show(points, frame);
    else outline.hide();
  },
});
const stones = new StoneCommands({
  state: () => viewer?.state ?? INITIAL,
  send: (event) => viewer?.send(event),
  choose: (id) => chosen.choose(id),
  tell: problem,
});

const saving = new Saving({
  seen: () => (session && viewer?.lastFrame ? { ...viewer.lastFrame, session } : null),
  scene: () => viewer?.state.scene ?? null,
  note: (text) => toasts.note(text),
});

/** Of one stone all was told when its mesh was opened. */
const findings = new Findings(
  async () => (session === null ? [] : (await rest.findSession(session)).findings),
  (text) => toasts.finding(text),
);

const open = {
  scene: (file: File) => attempt(() => openScene(file)),
  mesh: (file: File) => attempt(() => openMesh(file)),
  sky: (file: File) => attempt(() => openSky(file)),
};
const screen = new Screen(canvas, (size) => viewer?.resize(size));
const panel = new Panel(element("panel", HTMLElement), {
  perform,
  stones,
  removals: () => stones.removals,
  savePicture: (format) => attempt(() => saving.picture(format)),
  saveScene: () => attempt(() => saving.scene()),
  openScene: () => chooseFile(SCENE_TYPES, open.scene),
  openMesh: () => chooseFile(MESH_TYPES, open.mesh),
  openSky: () => chooseFile(SKY_TYPES, open.sky),
  patch: (patch) => viewer?.send({ type: "patch_scene", patch }),
  newSession: startAnew,
  clamped,
});
const strip = new SceneStrip(element("scenes", HTMLElement), element("scenes-toggle", HTMLButtonElement));
const fallButton = new FallButton(element("fall", HTMLButtonElement), () => perform(actionNamed("fall")));
const keyCard = new KeyCard(
  element("keys", HTMLDialogElement),
  element("keys-table", HTMLTableElement),
  element("keys-close", HTMLButtonElement),
);
const welcome = new Welcome(element("welcome", HTMLElement));
const bareness = new Bareness(element("main", HTMLElement), () => toasts.note(COME_BACK));
const embedding = embeddingAsked();
if (!embedding.ui) bareness.stay();
const meter = new Meter(element("meter", HTMLElement), (balance) => viewer?.send(balance), clamped);
const turntable = new Turntable(matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : embedding.rotate, (turn) =>
  viewer?.stream.send(turn),
);
function turnOn(now: number): void {
  if (viewer?.lastFrame) turntable.turn(now, viewer.player.shown);
  requestAnimationFrame(turnOn);
}
if (embedding.rotate !== 0) requestAnimationFrame(turnOn);
listenToKeys(window, perform);
listenToDrops(window, open, problem);
const hand = new Hand({
  ids: () => idsOf(viewer?.state.scene ?? null),
  pick: (x, y, told) => {
    const at = placeOf(x, y, screen.area);
    chosen.pick(at.x, at.y, told);
  },
  send: (event) => viewer?.send(event),
  size: () => ({ height: screen.area.height, side: Math.min(canvas.clientWidth, canvas.clientHeight) }),
});
listenToPointers(canvas, {
  target: () => viewer?.state.target ?? INITIAL.target,
  move,
  push: (push) => viewer?.send(push),
  click: (x, y) => {
    turntable.toggle();
    if (!embedding.ui) return;
    if (bareness.on) {
      bareness.toggle();
      return;
    }
    const at = placeOf(x, y, screen.area);
    if (idsOf(viewer?.state.scene ?? null).length > 1) chosen.pick(at.x, at.y);
  },
  hand,
  area: () => screen.area,
  zooms: (event) => embedding.ui || event.ctrlKey, // a pinch of a touchpad counts as with Ctrl
});

function perform({ effect, name }: Action): void {
  if (!embedding.ui && effect.kind !== "move" && !VIEWING.has(name)) return;
  if (effect.kind === "download") attempt(() => saving.picture(effect.format));
  else if (effect.kind === "copy") attempt(() => copy[effect.what]());
  else if (effect.kind === "page") onPage[effect.command]();
  else if (!viewer) problem("There is no session yet.");
  else if (effect.kind === "stones") stones[effect.command]();
  else if (effect.kind === "select") viewer.select(effect.target);
  else if (effect.kind === "move") move(effect.move, viewer.state.target);
  else send(viewer, effect.event);
}

/** Move the target: a stone only if it is known which. */
function move(by: Move, target: Target): void {
  turntable.rest(performance.now());
  const stone = stones.chosen();
  if (target === "stone" && stone === null) problem(CHOOSE_FIRST);
  else for (const event of movesOf(by, target, stone ?? "")) viewer?.send(event);
}

function send(to: Viewer, event: SessionEvent): void {
  const vain = to.untold ? null : inVain(to.state, event);
  if (vain) toasts.note(vain);
  else to.send(event);
}

const copy = { picture: () => saving.copyPicture(), link: () => saving.copyLink() };

/** What changes the page alone. */
const onPage = {
  showKeys: () => keyCard.toggle(),
  hideAll: () => bareness.toggle(),
  fillScreen: () =>
    attempt(() =>
      document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen(),
    ),
};
window.addEventListener("keydown", ({ key }) => {
  if (key === "Escape" && bareness.on) bareness.toggle();
});

/** A number was typed that is beyond what a slider can be at. */
function clamped(typed: number, taken: number): void {
  toasts.note(`${typed} is beyond the slider: ${taken} is taken.`);
}

/** What the address asks for; the whole page, and words about it, if that cannot be. */
function embeddingAsked(): Embedding {
  try {
    return embeddingOf(location.search);
  } catch (error) {
    problem(error instanceof Error ? error.message : String(error));
    return embeddingOf("");
  }
}

/** Run what may be refused, and tell the user why. */
function attempt(work: () => Promise<void>): void {
  work().catch((error: unknown) => problem(error instanceof Error ? error.message : String(error)));
}

function problem(text: string, about?: string): void {
  if (problems.push(text) > PROBLEMS_KEPT) problems.shift();
  toasts.problem(text, about);
}

async function openScene(file: File): Promise<void> {
  const scene = parseScene(await file.text(), file.name);
  panel.choices.forgetSky();
  stones.forget();
  viewer?.send({ type: "set_scene", scene });
}

/** Upload a file, with words about it for as long as that takes; a refusal names the file. */
async function read(file: File, upload: (file: File) => Promise<Upload>): Promise<Upload> {
  const clear = toasts.note(`Reading ${file.name}\u2026`);
  try {
    return await upload(file);
  } catch (error) {
    throw new Error(`${file.name}: ${error instanceof Error ? error.message : error}`);
  } finally {
    clear();
  }
}

async function openMesh(file: File): Promise<void> {
  const mesh = await read(file, rest.uploadMesh);
  files.keep(mesh.id, file, rest.uploadMesh);
  toasts.finding([`${file.name}:`, ...mesh.findings].join("\n"));
  viewer?.send({
    type: "patch_scene",
    patch: stonePatch(viewer.state.scene, { mesh: mesh.id }, viewer.state.stone ?? undefined),
  });
}

async function openSky(file: File): Promise<void> {
  const sky = await read(file, rest.uploadSky);
  files.keep(sky.id, file, rest.uploadSky);
  const summary = sky.findings.join("\n");
  toasts.finding(`${file.name}:\n${summary}`);
  panel.choices.addSkies([{ name: sky.id, title: file.name, summary }]);
  viewer?.send({ type: "patch_scene", patch: panel.choices.skyPatch(imageSky(sky.id)) });
}

function choosePreset({ scene }: Preset): void {
  panel.choices.forgetSky();
  stones.forget();
  viewer?.send({ type: "set_scene", scene: framed(scene, aspect()) });
}

/** Of what the picture covers: width by height. */
function aspect(): number {
  return canvas.clientWidth / Math.max(canvas.clientHeight, 1);
}

function startAnew(): void {
  location.assign(`/?${queryOf(embedding).slice(1)}`);
}

function connectionChanged(connection: Connection): void {
  showBanner(connection);
  if (connection.status === "closed") {
    if (connection.code === CloseCode.UNKNOWN_SESSION && session && !viewer?.ended) attempt(regain);
    else obstacle.show(obstacleText(connection.code, connection.reason), "Start a new session", startAnew);
  }
  // A gateway that was restarted may not know the session any more, and a proxy may hide its close code.
  if (connection.status === "waiting" && session) void leaveIfUnknown(session);
}

/** The server does not know the session any more: have it made again as this page last saw it. */
async function regain(tries = 0): Promise<void> {
  const scene = viewer?.state.scene;
  if (!viewer || !session || !scene) {
    return obstacle.show(obstacleText(CloseCode.UNKNOWN_SESSION, ""), "Start a new session", startAnew);
  }
  try {
    await recover({ id: session, scene, snapshot: viewer.snapshot }, files, rest.reopenSession);
    obstacle.hide();
    viewer.stream.open();
    toasts.finding(REGAINED);
  } catch (error) {
    const known = asProblem(error);
    if (rest.isPassing(known)) later(known.message, tries, regain);
    else obstacle.show(`${NOT_REGAINED}\n${known.message}`, "Start a new session", startAnew);
  }
}

/** The render process was replaced, and lacks files that the server has not got any more. */
async function giveFilesAgain(): Promise<void> {
  const scene = viewer?.state.scene;
  if (session && scene && (await files.giveAgain(scene))) await rest.patchSession(session, {});
}

/** What is wrong, or else why there is nothing to see. */
function showBanner(connection: Connection): void {
  const wrong = bannerText(connection, viewer?.state.engine ?? INITIAL.engine);
  banner.show(wrong);
  unseen.show(wrong === null ? elsewhere : null);
}

async function leaveIfUnknown(id: string): Promise<void> {
  try {
    await rest.findSession(id);
  } catch (error) {
    if (error instanceof rest.ProblemError && error.status === 404) {
      viewer?.stream.close(CloseCode.UNKNOWN_SESSION, error.message);
    }
  }
}

function stateChanged(before: ViewState, after: ViewState): void {
  chosen.there(idsOf(after.scene));
  if (stonesOf(after.scene).length > 1 && after.scene?.stones !== before.scene?.stones) findings.changed();
  panel.update(viewer?.state ?? after);
  fallButton.update(after);
  unseenButton.textContent = worded(LOOK, after.scene);
  meter.update(after);
  const change = describeChange(before, after);
  if (change) announcement.textContent = change;
  if (viewer) showBanner(viewer.stream.connection);
}

function firstShown(): void {
  if (embedding.ui) welcome.show();
  if (window.parent !== window) window.parent.postMessage(SHOWN, "*");
}

function watch(id: string): void {
  session = id;
  history.replaceState(null, "", sessionAddress(id, embedding));
  waiting.show(WAITING);
  const timer = setTimeout(() => waiting.show(WAITING_LONG), WAITING_LONG_MS);
  const whereabouts = new Whereabouts();
  let shownStep: bigint | null = null;
  viewer = new Viewer(streamUrl(location, id), {
    show: (picture, frame, arrival) => {
      screen.show(picture, refines(frame, shownStep));
      shownStep = frame.step;
      clearTimeout(timer);
      if (viewer?.player.shown === 0) firstShown();
      waiting.show(null);
      elsewhere = whereabouts.after(frame, arrival.time, viewer?.state.scene ?? null);
      if (viewer) showBanner(viewer.stream.connection);
      meter.take(frame, arrival);
      chosen.shown(frame.step, arrival.time);
    },
    size: () => screen.size,
    connection: connectionChanged,
    state: stateChanged,
    answer: (answer) => chosen.heard(answer),
    lacking: () => attempt(giveFilesAgain),
    problem,
  });
  panel.update(viewer.state);
  viewer.stream.open();
}

/** The id of a session that is made for this window. */
async function newSession(preset: string | undefined): Promise<string> {
  const { id, scene } = await rest.createSession(preset === undefined ? {} : { preset });
  const patch = framingPatch(scene, aspect());
  if (patch) await rest.patchSession(id, patch);
  return id;
}

/** Find or make the session; after `tries` that failed, since the server was not ready. */
async function start(tries = 0): Promise<void> {
  const wanted = wantedSession(location.search, location.hash);
  if (wanted.kind === "invalid") {
    return obstacle.show(`${wanted.id} is not the id of a session.`, "Start a new session", startAnew);
  }
  try {
    watch(await sessionFor(wanted));
    obstacle.hide();
  } catch (error) {
    banner.show(null);
    if (error instanceof LinkError) return obstacle.show(error.message, "Start a new session", startAnew);
    const known = asProblem(error);
    if (wanted.kind === "view" && known.status === 422) {
      return obstacle.show(`${VIEW_REFUSED}\n${known.message}`, "Start a new session", startAnew);
    }
    if (wanted.kind === "session" && known.status === 404) {
      return obstacle.show(obstacleText(CloseCode.UNKNOWN_SESSION, ""), "Start a new session", startAnew);
    }
    if (rest.isPassing(known)) later(known.message, tries, start);
    else obstacle.show(known.message, "Try again", () => attempt(start));
  }
}

/** The id of the session that is there, or of the one that is made. */
async function sessionFor(wanted: Exclude<Wanted, { kind: "invalid" }>): Promise<string> {
  switch (wanted.kind) {
    case "session":
      await rest.findSession(wanted.id);
      return wanted.id;
    case "view":
      return (await rest.createSession({ scene: fitted(await unpackedView(wanted.packed), aspect()) })).id;
    case "new":
      return newSession(wanted.preset);
  }
}

/** What the panel and the scenes are filled with. */
function loadCatalogues(): void {
  attempt(async () => strip.show(await rest.presets(), choosePreset));
  attempt(async () => panel.choices.addMaterials(await rest.materials()));
  attempt(async () => {
    const [cut] = await rest.cuts(); // there is one so far
    if (cut) panel.addCut(cut);
  });
  attempt(async () => panel.choices.addSkies(await rest.skies()));
  attempt(async () => panel.fall.addIntegrators(await rest.integrators()));
}

function asProblem(error: unknown): rest.ProblemError {
  return error instanceof rest.ProblemError ? error : new rest.ProblemError(500, String(error));
}

/** Try again after a pause, or at once if the user wants to. */
function later(why: string, tries: number, work: (tries: number) => Promise<void>): void {
  const again = () => {
    clearTimeout(timer);
    attempt(() => work(tries + 1));
  };
  const delay = pauseBefore(tries);
  const timer = setTimeout(again, delay);
  obstacle.show(`${why}\n${tryingAgainText(delay)}`, "Try now", again);
}

statusLine.title = `error as shown: ${ERROR_MEANINGS.shown}\nfrontier's error: ${ERROR_MEANINGS.frontier}`;
setInterval(() => {
  const now = performance.now();
  statusLine.textContent = statusText({
    framesPerSecond: viewer?.rate.perSecond(now) ?? 0,
    frame: viewer?.lastFrame ?? null,
    roundTripMs: viewer?.stream.latency.milliseconds ?? null,
    viewers: viewer?.state.viewers ?? 1,
  });
}, 500);

expose({
  get session() {
    return session;
  },
  get lastFrame() {
    return viewer?.lastFrame ? header(viewer.lastFrame) : null;
  },
  get fading() {
    return screen.fading;
  },
  get framesShown() {
    return viewer?.player.shown ?? 0;
  },
  get outOfOrder() {
    return viewer?.player.outOfOrder ?? 0;
  },
  get state() {
    return viewer?.state ?? INITIAL;
  },
  get target() {
    return viewer?.state.target ?? INITIAL.target;
  },
  get connection() {
    return viewer?.stream.connection.status ?? "connecting";
  },
  get roundTripMs() {
    return viewer?.stream.latency.milliseconds ?? null;
  },
  problems,
});
// A link that is pasted over one that could not be read is no other page to the browser.
window.addEventListener("hashchange", () => location.reload());
waiting.show("Connecting\u2026");
if (embedding.ui) loadCatalogues();
attempt(start);
