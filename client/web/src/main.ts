/** The page: its rooms, and what they tell each other. */

import { Clips } from "./clip/clips";
import { Comparison } from "./compare/comparison";
import { Division } from "./compare/division";
import { listenToDrops } from "./files/file-drop";
import { chooseFile, MESH_TYPES, SCENE_TYPES, SKY_TYPES } from "./files/files";
import { Opening } from "./files/opening";
import { Saving } from "./files/saving";
import { type Action, actionNamed } from "./input/actions";
import { FallButton } from "./input/fall-button";
import { inputTime } from "./input/input-time";
import { KeyCard } from "./input/key-card";
import { listenToKeys } from "./input/keys";
import { Performing } from "./input/performing";
import { steer } from "./input/steering";
import { text } from "./json";
import { Delays } from "./meter/delays";
import { Meter } from "./meter/meter";
import { showStatus } from "./meter/status-line";
import { element } from "./page";
import { Panel } from "./panel/panel";
import { ChosenStone } from "./picture/chosen-stone";
import { type Embedding, embeddingOf, Turntable, tellAround } from "./picture/embedding";
import { Legend } from "./picture/legend";
import { OutlineView } from "./picture/outline-view";
import { afterPainting, Screen } from "./picture/screen";
import { ShownPicture } from "./picture/shown-picture";
import { Whereabouts } from "./picture/whereabouts";
import { WindowFit } from "./picture/window-fit";
import { exposeVisit } from "./probe";
import { RayMode } from "./ray/ray-mode";
import { SceneStrip } from "./scenes/scene-strip";
import { Acknowledged } from "./session/acknowledged";
import type { SessionEvent } from "./session/events";
import { Findings } from "./session/findings";
import { OpenedFiles } from "./session/recovery";
import * as rest from "./session/rest";
import { wantedSession } from "./session/session-url";
import { describeChange, type ViewState } from "./session/view-state";
import { Visit } from "./session/visit";
import { ShareCard } from "./share/share-card";
import { Bareness } from "./signs/bareness";
import { Complaints, reasonOf } from "./signs/complaints";
import { Signs } from "./signs/signs";
import { slowly } from "./signs/slowly";
import { Toasts } from "./signs/toasts";
import { Welcome } from "./signs/welcome";
import { StoneCommands } from "./stones/stone-commands";
import { idsOf, stoneOf, stonesOf } from "./stones/stones";
import { fillPage } from "./words/fill";
import { worded } from "./words/wording";
import { words } from "./words/words";

/** What is left to do, beside moves, where a page shows nothing but the picture. */
const VIEWING: ReadonlySet<Action["name"]> = new Set(["reset_camera", "look", "full", "fit"]);

/** What is done to the scene whatever a slider was about to do. */
const ENDING: ReadonlySet<SessionEvent["type"]> = new Set(["undo", "redo", "set_scene"]);

/** A first picture that takes longer, or never comes, keeps the lists of what there is waiting no more. */
const PATIENCE_MS = 1500;
const catalogues = { asked: false };

fillPage(document);
const canvas = element("picture", HTMLCanvasElement);
const announcement = element("announcement", HTMLElement);
const toasts = new Toasts(element("toasts", HTMLElement));
const complaints = new Complaints(toasts);
const attempt = (work: () => Promise<void>) => complaints.attempt(work);
const embedding = embeddingAsked();
const files = new OpenedFiles();
const signs = new Signs(
  () => visit.send({ type: "look_at_stone" }),
  () => visit.startAnew(),
  (text, passes) => tellAround({ culet: "obstacle", text, passes }),
);
const screen = new Screen(canvas, (size) => {
  visit.viewer?.resize(size);
  windowFit?.offer(offersFit());
});
const shown = new ShownPicture(screen);
const aspect = () => canvas.clientWidth / Math.max(canvas.clientHeight, 1);
const whereabouts = new Whereabouts();
const visit = new Visit(
  {
    size: () => screen.size,
    aspect,
    show: (picture, frame, arrival) => {
      const seen = shown.show(picture, frame);
      if (visit.viewer?.player.shown === 0) firstShown();
      windowFit?.offer(offersFit());
      signs.arrived();
      signs.stones(whereabouts.after(frame, arrival.time, visit.scene));
      chosen.shown(frame.step, arrival.time);
      ray.shown();
      division.shown();
      if (!seen) return;
      meter.take(frame, arrival);
      clips.take(frame, arrival.time);
      if (delays.on) afterPainting((time) => meter.delayed(delays.painted(frame, arrival, time)));
    },
    state: stateChanged,
    answer: (answer) => {
      if (answer.type !== "reached") return chosen.heard(answer);
      acknowledged.heard(answer);
      meter.delayed(delays.heard(answer, performance.now()));
    },
    refused: (problem) => acknowledged.refused(problem),
    sent: (event) => {
      if (ENDING.has(event.type)) panel.forget();
      delays.sent(event, inputTime(), performance.now());
    },
    tell: (text) => toasts.finding(text),
  },
  signs,
  complaints,
  files,
  embedding,
);
const outline = new OutlineView(element("outline", SVGSVGElement), canvas);
screen.refitted = (fit) => {
  outline.refit(fit);
  element("main", HTMLElement).classList.toggle("filled", fit === "filled");
};
/** Whoever steers sees what the session's picture is; whoever watches may want a full window of it. */
const windowFit = watchesOnly() ? new WindowFit(element("fit", HTMLButtonElement), (fit) => screen.fill(fit)) : null;
const legend = new Legend(element("legend", HTMLElement));
const chosen = new ChosenStone({
  ask: (question) => visit.viewer?.ask(question),
  chosen: (id) => visit.viewer?.choose(id),
  outline: (points) => {
    if (points && visit.lastFrame) outline.show(points, visit.lastFrame, screen.fits);
    else outline.hide();
  },
});
const stones = new StoneCommands({
  state: () => visit.state,
  send: (event) => visit.send(event),
  choose: (id) => chosen.choose(id),
  tell: (text) => complaints.tell(text),
});
const saving = new Saving({
  seen: () => (visit.session && visit.lastFrame ? { ...visit.lastFrame, session: visit.session } : null),
  scene: () => visit.scene,
  note: (text) => void toasts.note(text),
  notice: (text) => toasts.notice(text),
});
/** Of one stone all was told when its mesh was opened. */
const findings = new Findings(
  async () => (visit.session === null ? [] : (await rest.findSession(visit.session)).findings),
  (text) => toasts.finding(text),
);
const opening = new Opening(
  {
    state: () => visit.state,
    session: () => visit.session,
    send: (event) => visit.send(event),
    aspect,
    forget: () => {
      panel.choices.forgetSky();
      stones.forget();
    },
    offerSky: (sky) => panel.choices.addSkies([sky]),
    skyPatch: (sky) => panel.choices.skyPatch(sky),
  },
  files,
  toasts,
);
const open = {
  scene: (file: File) => attempt(() => opening.scene(file)),
  mesh: (file: File) => attempt(() => opening.mesh(file)),
  sky: (file: File) => attempt(() => opening.sky(file)),
};
const keyCard = new KeyCard(
  element("keys", HTMLDialogElement),
  element("keys-table", HTMLTableElement),
  element("keys-close", HTMLButtonElement),
);
const bareness = new Bareness(element("main", HTMLElement), () => toasts.note(words.connection.comeBack));
const turntable = new Turntable(
  matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : embedding.rotate,
  (turn) => {
    if (visit.state.steers) visit.viewer?.stream.send(turn);
  },
);
const ray = new RayMode({
  visit,
  canvas,
  complaints,
  changed: (on) => {
    element("main", HTMLElement).classList.toggle("tracing", on);
    if (on) panel.makeRoom();
  },
});
const clips = new Clips({
  task: (text, button, end) => toasts.task(text, button, end),
  recording: (on) => panel.recording(on),
});
const page = {
  showKeys: () => keyCard.toggle(),
  hideAll: () => bareness.toggle(),
  traceRay: () => attempt(() => ray.toggle()),
  changeDesigns,
  divide,
  fit: () => (windowFit ? windowFit.toggle() : void toasts.note(words.fit.own)),
  moved: () => turntable.rest(performance.now()),
  note: (text: string) => void toasts.note(text),
};
const comparison = new Comparison();
const division = new Division({ visit, canvas, comparison, complaints });
const performing = new Performing({ visit, stones, saving, clips, page, complaints });
const panel = new Panel(element("panel", HTMLElement), {
  perform,
  stones,
  removals: () => stones.removals,
  savePicture: (format) => attempt(() => saving.picture(format)),
  saveScene: () => attempt(() => saving.scene()),
  openScene: () => chooseFile(SCENE_TYPES, open.scene),
  openMesh: () => chooseFile(MESH_TYPES, open.mesh),
  openSky: () => chooseFile(SKY_TYPES, open.sky),
  patch: (patch) => visit.send({ type: "patch_scene", patch }),
  newSession: () => visit.startAnew(),
  keepDesign,
  changeDesigns,
  divide,
  otherwise: (scene) => comparison.otherwise(scene),
  grades: (stone, tilt, signal) => rest.grades(visit.session ?? "", stone, tilt, signal),
  steps: {
    after: (work) => acknowledged.after(work),
    working: () => slowly(() => toasts.notice(words.cut.working)),
    failed: (why) => complaints.tell(why),
  },
  tiers: (scene, reach, signal) => rest.tiers(visit.session ?? "", text(stoneOf(scene).id, ""), reach, signal),
  measure: (scene) => rest.proportions(scene),
  openDiagram: (stone) => window.open(rest.diagramAddress(visit.session ?? "", stone), "_blank", "noopener"),
  share: () => attempt(() => share()),
  clamped,
});
complaints.shownElsewhere = (text, about) => panel.refused(text, about);
const strip = new SceneStrip(element("scenes", HTMLElement), element("scenes-toggle", HTMLButtonElement));
const shareCard = new ShareCard(
  element("share", HTMLDialogElement),
  element("share-links", HTMLElement),
  element("share-close", HTMLButtonElement),
);
const fallButton = new FallButton(element("fall", HTMLButtonElement), () => perform(actionNamed("fall")));
const welcome = new Welcome(element("welcome", HTMLElement));
const acknowledged = new Acknowledged(
  (question) => visit.viewer?.ask(question),
  () => visit.viewer?.stream.sent ?? { connection: 0, count: 0 },
);
const delays = new Delays((question) => visit.viewer?.ask(question));
const meter = new Meter(
  element("meter", HTMLElement),
  (balance) => visit.send(balance),
  (open) => {
    delays.on = open;
  },
  clamped,
);

function perform(action: Action): void {
  const views = VIEWING.has(action.name) || (visit.only && action.name === "divide");
  if (!embedding.ui && action.effect.kind !== "move" && !views) return;
  performing.perform(action);
}

/** Keep the design of the chosen stone, or of the first. */
function keepDesign(): void {
  const { kept, keptToWatch } = words.compare;
  if (comparison.keep(visit.scene, visit.state.stone)) toasts.note(visit.only ? keptToWatch : kept);
  else complaints.tell(words.compare.noStone);
  division.kept();
}

/** Show both designs with a divider, or the one alone; without a kept one keep this. */
function divide(): void {
  // Whoever watches has no other way to keep a design than to begin.
  if (!comparison.keeps(visit.scene) || (visit.only && !division.on)) keepDesign();
  if (!comparison.keeps(visit.scene)) return;
  attempt(() => division.toggle());
}

/** Show the design that is kept, and keep the one that is shown; the first time keep it. */
function changeDesigns(): void {
  const patch = comparison.change(visit.scene);
  if (patch) {
    panel.forget();
    visit.send({ type: "patch_scene", patch });
  } else keepDesign();
}

/** A number was typed that is beyond what a slider can be at. */
function clamped(typed: number, taken: number): void {
  toasts.note(words.sliders.clamped(typed, taken));
}

/** What the address asks for; the whole page, and words about it, if that cannot be. */
function embeddingAsked(): Embedding {
  try {
    const asked = embeddingOf(location.search);
    // Of a session that is only watched the picture is all that there is to use.
    return wantedSession(location.search).kind === "watch" ? { ...asked, ui: false } : asked;
  } catch (error) {
    complaints.tell(reasonOf(error));
    return embeddingOf("");
  }
}

function watchesOnly(): boolean {
  try {
    return wantedSession(location.search).kind === "watch";
  } catch {
    return false;
  }
}

/** In another page's frame the key alone changes it. */
function offersFit(): boolean {
  return screen.differs && window.parent === window;
}

function stateChanged(before: ViewState, after: ViewState): void {
  chosen.there(idsOf(after.scene));
  ray.changed(before.scene, after.scene);
  if (stonesOf(after.scene).length > 1 && after.scene?.stones !== before.scene?.stones) findings.changed();
  panel.update(visit.state);
  if (embedding.legend) legend.update(after.scene);
  fallButton.update(after);
  signs.lookLabel(worded(words.whereabouts.look, after.scene));
  meter.update(after);
  const change = describeChange(before, after);
  if (change) announcement.textContent = change;
}

async function share(): Promise<void> {
  const { session, viewer } = visit;
  if (session === null || !viewer?.watchId) throw new Error(words.connection.noSessionYet);
  await shareCard.show({ session, watch: viewer.watchId });
}

function firstShown(): void {
  if (embedding.ui) {
    welcome.show();
    loadCatalogues();
  }
  tellAround({ culet: "shown" });
}

/** What the panel and the scenes are filled with: once, and not while the first picture is being made. */
function loadCatalogues(): void {
  if (catalogues.asked) return;
  catalogues.asked = true;
  attempt(async () => strip.show(await rest.presets(), (preset) => opening.preset(preset)));
  attempt(async () => panel.choices.addMaterials(await rest.materials()));
  attempt(async () => panel.addCuts(await rest.cuts()));
  attempt(async () => panel.choices.addSkies(await rest.skies()));
  attempt(async () => panel.fall.addIntegrators(await rest.integrators()));
}

function turnOn(now: number): void {
  if (visit.viewer?.lastFrame) turntable.turn(now, visit.viewer.player.shown);
  requestAnimationFrame(turnOn);
}

if (!embedding.ui) bareness.stay();
if (embedding.rotate !== 0) requestAnimationFrame(turnOn);
listenToKeys(window, perform);
listenToDrops(window, open, (text) => complaints.tell(text));
steer({ canvas, screen, visit, chosen, performing, turntable, bareness, embedding, ray });
window.addEventListener("keydown", ({ key }) => {
  if (key !== "Escape" || document.querySelector("dialog[open]")) return;
  if (bareness.on) bareness.toggle();
  else if (ray.on) attempt(() => ray.toggle());
});
// A link that is pasted over one that could not be read is no other page to the browser.
window.addEventListener("hashchange", () => location.reload());
showStatus(element("status", HTMLElement), visit);
exposeVisit(visit, screen, delays, complaints.kept);
panel.update(visit.state);
attempt(() => visit.start());
if (embedding.ui) setTimeout(loadCatalogues, PATIENCE_MS);
