/**
 * All words of the page, in English. What a server says of errors, materials, scenes and files is the server's.
 *
 * A text is a string; a `Wording` where it reads otherwise with one stone than with several; a function where values or
 * counts are in it. Another language is a module beside this one with the same names: see `words.ts`.
 */

import type { Wording } from "./wording";

export const language: string = "en";

/** Something to choose or to set: what it is called, and what it means. */
type Named = readonly [name: string, meaning: string];

/** Of index.html, by `data-words` and `data-label`. */
export const page = {
  picture:
    "Live picture of the stones. Drag to orbit, wheel or pinch to come nearer, click to choose a stone; arrow keys, I and " +
    "O move the camera or the chosen light; the panel lists all keys.",
  noCanvas: "Your browser cannot show the picture: it has no canvas.",
  scenes: "Scenes",
  connecting: "connecting",
  keysTitle: "Keys, mouse and fingers",
  shareTitle: "Share this session",
  close: "Close",
};

/** What keys and buttons do, by the actions' names. */
export const actions = {
  camera: "Move the camera",
  light_1: "Move the red light",
  light_2: "Move the blue light",
  stone: "Move the chosen stone",
  left: "Left",
  right: "Right",
  up: "Up",
  down: "Down",
  in: "In",
  out: "Out",
  turn_left: "Turn left",
  turn_right: "Turn right",
  turn_up: "Turn up",
  turn_down: "Turn down",
  reset_camera: "Reset the camera",
  look: { one: "Look at the stone", several: "Look at the chosen stone, or all" },
  fall: "Fall or pause",
  reset_stone: { one: "Put the stone back", several: "Put the stones back" },
  mirror: "Mirror or checker",
  sky: "Light sky, or the scene's own",
  walls: "Walls",
  remove_stone: { one: "Remove the stone", several: "Remove the chosen stone" },
  put_back_stone: "Take a removal back",
  undo: "Undo",
  redo: "Redo",
  download: "Save the picture (.png)",
  copy_picture: "Copy the picture",
  copy_link: "Copy a link to this view",
  clip_last: "Save a clip of the last 10 s",
  clip_next: "Record a clip of the next 10 s",
  ray: "Draw one ray",
  compare: "Keep the design, or change it with the one that is kept",
  divide: "Show the kept design beside this one, with a divider",
  keys: "All keys",
  hide: "Hide all but the picture",
  fit: "Where you only watch: fill the window with the picture, or show all of it",
  full: "Fill the screen",
} satisfies Record<string, string | Wording>;

/** Keys of which the printed name is no letter, by `KeyboardEvent.key` in lower case. */
export const keyNames: Record<string, string> = {
  arrowleft: "\u2190",
  arrowright: "\u2192",
  arrowup: "\u2191",
  arrowdown: "\u2193",
  delete: "Del",
  "ctrl+z": "Ctrl Z",
  "ctrl+shift+z": "Ctrl Shift Z",
  "shift+arrowleft": "Shift \u2190",
  "shift+arrowright": "Shift \u2192",
  "shift+arrowup": "Shift \u2191",
  "shift+arrowdown": "Shift \u2193",
};

/** How a picture of another shape than the window is shown to who only watches. */
export const fit = {
  fill: "Fill the window",
  whole: "Show all of the picture",
  own: "Only a window that watches by a watching link can be filled.",
};

/** What is done without a key: how, and what it does. */
export const gestures: readonly (readonly [string, string])[] = [
  ["Drag", "Turn the view; of a light that is chosen, move the light around; turn a stone that is to be moved"],
  ["Wheel, pinch", "Nearer, farther"],
  ["Click, tap", "Choose a stone, where there are several; with T draw the ray there, arrow keys go through it"],
  ["Shift and drag", "Throw the stone under the pointer"],
  ["Ctrl and drag", "Move the stone under the pointer; with Shift turn it"],
  ["Esc", "Close this card, leave the full screen, show all again, or end a ray"],
];

/** One ray, drawn and told. */
export const ray = {
  title: "One ray",
  how: "Click a point of the stone: its light is drawn from your eye to where it comes from.",
  waits: "The ray is being followed…",
  close: "Close",
  steps: "Steps of the light",
  columns: ["Step", "Light", "What happens", "Angle", "Share"],
  dark: "No light comes by this ray.",
  share: (percent: string, from: string) => `${percent} of this pixel comes from ${from}`,
  ofPixel: (percent: string) => `${percent} of the pixel`,
  lamp: (side: string, number: string) => `the lamp ${side} (emitter ${number})`,
  sides: {
    above: "overhead",
    below: "below",
    left: "at the left",
    right: "at the right",
    ahead: "ahead of you",
    behind: "behind you",
  },
  met: {
    sky: "the sky",
    head: "your head, seen in the stone",
    backdrop: "the backdrop",
    floor: "the floor",
    "left-wall": "the left wall",
    "middle-wall": "the middle wall",
    "right-wall": "the right wall",
    cut: "what stands for dropped light",
    untold: "what was too much to tell",
  },
  allLight: "all",
  channels: { red: "R", green: "G", blue: "B" },
  facet: (stone: string, name: string) => `${name} of ${stone}`,
  unnamed: (number: string) => `facet ${number}`,
  happens: {
    enters: (facet: string) => `enters by ${facet}`,
    total: (facet: string) => `totally reflected at ${facet}`,
    leaves: (facet: string, kept: string) => `leaves by ${facet}, ${kept} reflected`,
    mirrored: (kept: string) => `mirrored, ${kept}`,
    lands: "ends on a surface",
    sees: (from: string) => `comes from ${from}`,
    outside: "outside",
    ends: "is dropped: too faint",
    endsInside: "is dropped inside: too faint",
    chance: "goes on by chance",
  },
  facts: {
    light: "Light",
    incidence: "Angle of incidence",
    critical: "Critical angle",
    refraction: "Angle on the other side",
    reflectance: "Reflectance",
    polarised: (s: string, p: string, mean: string) => `s ${s}, p ${p}, mean ${mean}`,
    length: "Way in the stone",
    before: "Weight where it came from",
    arrives: "After absorption",
    kept: "Weight that is reflected",
    passes: "Weight that goes through",
    polarisation: "Polarisation so far",
    elevation: "Above the horizon",
    cut: "Weight that is dropped",
  },
};

/** What a first visit is told. */
export const welcome = {
  fingers: "Drag to turn the stone. The round button lets it fall.",
  mouse: "Drag to turn the stone. P lets it fall, S saves the picture, ? shows all keys.",
};

/** Headings and buttons of the panel. */
export const panel = {
  title: "culet",
  stone: { one: "Stone", several: "Stones" },
  surroundings: "Surroundings",
  move: "Move",
  cut: "Cut",
  fall: "Fall",
  surfaces: "Floor and walls",
  optics: "Optics",
  files: "Pictures and scenes",
  page: "Help and page",
  falling: "Falling",
  mirror: "Mirror",
  lightSky: "Light sky",
  walls: "Walls",
  moved: "What",
  tilt: "Tilt, \u00b0",
  direction: "Toward, \u00b0",
  directionHint: "The side that the camera is tilted to: 0 is the picture's lower edge face up, 90 its right one",
  head: "Head, \u00b0",
  headHint:
    "Half the angle of the cone that the observer's head fills: ASET's has 15, or 20 close by; the Ideal-Scope's 10",
  tiltHint: "Of the camera: 0 looks straight down, which shows a stone face up; 90 looks from the side",
  saveWebp: "Save the picture (.webp)",
  saveTga: "Save the picture (.tga)",
  saveExr: "Save the picture's light (.exr)",
  share: "Share this session\u2026",
  saveScene: "Save the scene (.json)",
  openScene: "Open a scene\u2026",
  openMesh: "Open a mesh or design\u2026",
  openSky: "Open a sky\u2026",
  newSession: "New session",
};

/** In a corner of the picture: what an instrument's colours mean, in degrees of elevation, and the tilt. */
export const legend = {
  above: (from: number, to: number) => `From above, ${from}\u00b0 to ${to}\u00b0`,
  aside: (to: number) => `From aside, 0\u00b0 to ${to}\u00b0`,
  head: (from: number) => `Your head, ${from}\u00b0 to 90\u00b0`,
  back: (to: number) => `Comes back, 0\u00b0 to ${to}\u00b0`,
  leak: "Leak",
  faceUp: "Face up",
  tilted: (degrees: number, toward: number) => `Tilted ${degrees.toFixed(1)}\u00b0 toward ${toward}\u00b0`,
};

/** The card with a session's links. */
export const share = {
  steer: "Whoever has this link watches and steers:",
  watch: "Whoever has this link only watches:",
  copy: "Copy",
  copied: "The link is on the clipboard.",
  selected: "This browser does not let the page write to the clipboard. The link is selected: copy it from here.",
  code: "The watching link as a QR code",
  ownMachine: "These links lead to this machine only: start culet with --host 0.0.0.0 to be reached by others.",
};

export const sliders = {
  clamped: (typed: number, taken: number) => `${typed} is beyond the slider: ${taken} is taken.`,
};

/** What is moved by keys and drags. */
export const targets = {
  camera: "camera",
  light_1: "red light",
  light_2: "blue light",
  stone: "chosen stone",
};

/** The panel's list of stones, and what is done to them. */
export const stones = {
  chosen: "Chosen",
  none: "(none)",
  look: "Look at this stone",
  putBack: "Put this stone back",
  hold: "Hold this stone, or let go",
  add: "Add another like it",
  scatter: "Scatter all",
  chooseFirst: "Choose a stone first: click it, or take it from the panel's list.",
  noStone: "There is no stone.",
  noRoom: (most: number) => `A scene has at most ${most} stones.`,
  nothingRemoved: "You have removed no stone.",
};

export const material = {
  label: "Material",
  own: "its own indices",
  facts: (index: number, criticalDegrees: number, brewsterDegrees: number, dispersion: number) =>
    `index ${index.toFixed(3)} \u00b7 dispersion ${dispersion.toFixed(3)}\n` +
    `critical angle ${criticalDegrees.toFixed(1)}\u00b0 \u00b7 Brewster's ${brewsterDegrees.toFixed(1)}\u00b0`,
  factsHint:
    "Index of refraction, for green light; dispersion, how much greater the index is for blue than for red. Inside the " +
    "stone, beyond the critical angle from a facet's normal, all light is reflected; outside, at Brewster's angle, what " +
    "is reflected is polarised",
  radius: "Radius, mm",
  radiusHint: "Of the girdle: the longer the ways through the stone, the deeper its colour. One carat is 3.25 mm",
};

/** Skies that are no pictures, by their kind: name, and what it is. */
export const skies = {
  label: "Sky",
  studio: ["studio lamps", "The scene's own lamps and soft boxes"],
  dark: ["dark", "The report's night: lamps alone are bright"],
  light: ["light", "The report's day: bright all around"],
  half: ["half-lit", "Bright on one side, dark on the other"],
} satisfies Record<string, Named | string>;

export const optics = {
  bands: "Bands",
  bandsHint: "Wavelengths that are followed. 3: one each of red, green and blue; more spread the fire into a spectrum",
  autoBands: "3, more at rest",
  autoBandsHint:
    "Red, green and blue while things move; a spectrum while the picture rests, if the material spreads light",
  polarised: "Polarised",
  polarisedHint: "Follow how reflections polarise the light; without it, light is averaged at each one",
  cutoff: "Cut-off",
  cutoffHint: "Light that brings less than this part of what it began with is followed no further",
  end: "Below it",
  endHint: "What becomes of light below the cut-off",
  toneMap: "Tone map",
  hideFireflies: "Hide fireflies",
  hideFirefliesHint:
    "Leave out samples that are far brighter than all others of their pixel: fewer dots while a picture refines, and a " +
    "little less light. Saved radiance keeps them",
  toneMapHint: "How radiance becomes the colours of the screen",
  caustics: "Caustics",
  causticsHint:
    "Light that stones throw onto a matte floor and matte walls: flecks, and the rainbows in them. Without it they " +
    "throw their shadows alone",
  noCausticsHint: "Neither floor nor walls are matte: there is nothing that caustics could be seen on",
};

/** What becomes of light below the cut-off, by the scene's names: name, and what it is. */
export const ends = {
  cut: [
    "cut, counted",
    "Weak light is dropped. The picture says how much light was dropped: it is darker by that at most",
  ],
  roulette: [
    "by chance",
    "Weak light is dropped at random, and the light that goes on counts for more: right on average, but noisy",
  ],
  sky: [
    "in the sky",
    "Weak light leaves the stone at once and meets the sky: the picture is not darker, but this is a guess",
  ],
} satisfies Record<string, Named>;

/** Tone maps by the scene's names: name, and what it is. */
export const toneMaps = {
  neutral: ["neutral", "As it is, but for what is brighter than 0.8: that approaches white without reaching it"],
  srgb: ["sRGB", "What is brighter than white is white"],
  filmic: ["filmic", "Highlights are rolled off, and keep their hues"],
  classic: ["the report's", "As the report draws it"],
  none: ["none", "The radiance itself, without the screen's curve: too dark on a screen"],
} satisfies Record<string, Named>;

export const cut = {
  shape: "Shape",
  /** Shown in the list of cuts for a stone whose shape comes from a file. */
  own: "A file's",
  usual: "The usual proportions",
  working: "The stone is being cut\u2026",
  /** Of the design of a file, by the scene's names: label, and what it means. */
  anew: {
    crown_ratio: [
      "Crown, ratio",
      "The tangent of each crown facet's angle is so many times the file's; all meets are kept",
    ],
    pavilion_ratio: [
      "Pavilion, ratio",
      "The tangent of each pavilion facet's angle is so many times the file's: 1.018 makes 41.25\u00b0 of 40.75\u00b0; all " +
        "meets are kept",
    ],
    girdle_percent: ["Girdle, %", "From its lowest corner to its highest, of the stone's width: the crown is moved"],
    table_percent: ["Table, %", "The top facet's width, of the stone's: it is cut higher or lower"],
  } satisfies Record<string, Named>,
  asItCame: "As the file has it",
  /** Angles of single tiers. */
  tiers: {
    crown: "Crown angles",
    pavilion: "Pavilion angles",
    unnamed: (tier: string) => `Tier ${tier}`,
    hint: (tier: string, facets: number, reach: { least: number; most: number } | null) =>
      `Tier ${tier}, ${facets} ${facets === 1 ? "facet" : "facets"}: degrees from the horizontal. All meets are kept` +
      (reach ? `, from ${reach.least}\u00b0 to ${reach.most}\u00b0` : ""),
    angle: (tier: string, degrees: string) => `${tier} ${degrees}\u00b0`,
    following: (tiers: string) => `These follow: ${tiers}.`,
    none: "No tier of this side can be turned.",
    asTheyWere: "These angles as they were",
  },
  /** The name of a proportion, from the words of the scene's name for it, with its unit. */
  proportion: (said: string, unit: "percent" | "degrees" | null) => {
    const ending = { percent: ", %", degrees: ", \u00b0" };
    return said.charAt(0).toUpperCase() + said.slice(1) + (unit ? ending[unit] : "");
  },
};

/** Two designs that are changed over. */
export const compare = {
  keep: "Keep this design to compare",
  change: "Show the kept design",
  divide: "Both, with a divider",
  divider: "Divider between the kept design, at its left, and the one that is shown",
  keptPicture: "The kept design, under the same camera and light",
  keptSide: "kept",
  keptWaits: "kept: being rendered\u2026",
  shownSide: "shown",
  at: (percent: number) => `${percent}\u00a0% of the picture is the kept design's`,
  kept:
    "This design is kept. Choose or change another one: the grades tell how they differ, the key A changes the two " +
    "over, and D shows both.",
  keptToWatch: "This design is kept: when another one comes, both are shown with a divider. D ends it.",
  noStone: "There is no stone whose design could be kept.",
};

/** The stone's grades: docs/reference/grading.md defines each. */
export const grades = {
  title: "Grades",
  tilt: "Tilt curves",
  waits: "The stone is being graded\u2026",
  diagram: "Cutting diagram",
  degrees: "Tilt, \u00b0",
  tiltPoint: (degrees: number, iso: string) => `${iso} % at ${degrees}\u00b0`,
  tiltCurve: (axis: string, points: string) => `${axis}: ${points}.`,
  /** Of the tilt curves: which of its own axes the stone turns about. */
  axes: ["ISO, about x", "ISO, about z"],
  size: (millimetres: string, carats: string) => `${millimetres} mm, ${carats} ct`,
  differenceHint: (hint: string) => `${hint}. Last: less that of the kept design`,
  sure: (meaning: string, error: string, bound: string) =>
    `${meaning}. Standard error ${error}, cut off at most ${bound}`,
  /** Name, and what it is. */
  lines: {
    iso: ["Brightness, ISO", "Of an even dome, dark where your head is"],
    cos: ["Brightness, COS", "Of a dome that is brightest above"],
    sc2: ["Brightness, SC2", "Of a dome that is brightest at 45\u00b0"],
    contrast: ["Contrast", "Standard deviation of the brightness over the stone"],
    fire: ["Fire", "Light whose blue and red come from directions that an eye tells apart"],
    window: ["Window", "Light that goes straight through: what lies below is seen"],
    extinction: ["Extinction", "Area that is darker than a tenth of the dome"],
    leak: ["Leak", "Light from below the horizon"],
    red: ["From above (ASET red)", "Light from 45\u00b0 to 75\u00b0 of elevation"],
    green: ["From aside (ASET green)", "Light from below 45\u00b0 of elevation"],
    blue: ["From the head (ASET blue)", "Light from over 75\u00b0 of elevation"],
    weightedLightReturn: ["Weighted light return", "GIA's, a part of 1"],
  } satisfies Record<string, Named>,
};

/** The sliders of the fall: label, and what it means. */
export const fall = {
  height: ["Drop height, R", "From the floor to the bounding sphere"],
  spin: ["Spin, rad/s", "At the start, about the axis that the scene has"],
  gravity: ["Gravity, R/s\u00b2", "R is the stone's radius"],
  restitution: ["Restitution", "Speed after a bounce, of that before"],
  friction: ["Friction", "Coulomb's coefficient"],
  rolling: ["Rolling resistance", "As a lever arm, R"],
  model: "Model",
  rigid: "rigid body",
  classic: "the report's",
  integrator: "Integrator",
} satisfies Record<string, Named | string>;

export const fallButton = {
  fall: { one: "Let the stone fall", several: "Let the stones fall" },
  pause: "Pause the fall",
};

export const surfaces = {
  floor: "Floor",
  walls: "Walls",
  checkered: (surface: string) => `${surface}, checkered`,
  cell: (surface: string) => `${surface}, cell, R`,
  other: (surface: string) => `${surface}, other cells`,
  albedoHint:
    "What the surface looks like in white light: the part of each colour that it gives back. Flecks show best on a dark one",
  checkeredHint: "Whether every other cell has a colour of its own",
  cellHint: "Side of a cell; R is the stone's radius",
  otherHint: "Of every other cell, in white light",
  notMatte: "Only what is matte has a colour of its own: this is not now",
};

/** Speed and exactness: the balance, and what comes of it. */
export const meter = {
  title: "Speed and exactness",
  exactness: "Exactness",
  exactnessHint: "0: many frames a second; 1: few and good ones. For all viewers of this session",
  pinned: "Pin the quality",
  pinnedHint: "Moving frames keep this quality, however long they take",
  byRate: (framesPerSecond: number) => `In motion: ${framesPerSecond.toFixed(0)} frames/s, as good as time allows.`,
  exact: "In motion: all that the scene asks for, however long it takes.",
  byQuality: (exactness: number) =>
    `In motion: quality held at ${Math.round(exactness * 100)} %, however long it takes.`,
  bands: (count: number) => `${count} bands`,
  cutoff: (part: string) => `cut-off ${part}`,
  bounces: (count: number) => `${count} bounces`,
  polarised: "polarised",
  unpolarised: "unpolarised",
  stagesTitle: "Milliseconds a frame, by stage",
  stages: { simulate: "simulate", render: "render", encode: "encode", network: "network", decode: "decode" },
  delay: (total: string, parts: string) => `From input to picture ${total} ms: ${parts}`,
  delayStages: {
    way: "to the server",
    wait: "waiting",
    simulate: "simulate",
    render: "render",
    encode: "encode",
    network: "back",
    paint: "decode and paint",
  },
  errorsTitle: "Error of the radiance, root mean square",
  frontier: "frontier's, moving",
  estimated: "estimated, at rest",
  now: "now",
  seconds: (value: number) => `${value} s`,
};

/** The status line. */
export const status = {
  still: "still picture",
  refining: "refining",
  framesPerSecond: (rate: number) => `${rate.toFixed(1)} frames/s`,
  limitedBy: {
    rendering: "limited by rendering",
    network: "limited by the network",
    browser: "limited by this browser",
  },
  slowMotion: "slow motion",
  perSample: (ms: string) => `render ${ms} ms a sample`,
  server: (all: string, simulate: string, render: string, encode: string) =>
    `server ${all} ms (simulate ${simulate}, render ${render}, encode ${encode})`,
  waiting: "waiting for the first picture",
  offline: "not connected",
  roundTrip: (ms: string) => `round trip ${ms} ms`,
  samples: (count: number) => (count === 1 ? "1 sample" : `${count} samples`),
  viewers: (count: number) => (count === 1 ? "1 viewer" : `${count} viewers`),
  size: (width: number, height: number) => `${width}\u00d7${height}`,
  codecs: { JPEG: "JPEG", PNG: "PNG", H264: "H.264", VP9: "VP9" },
  error: "error",
  frontiersError: "frontier's error",
  errorIs: (name: string, value: string) => `${name} ${value}`,
  shownError: (value: string) => `error ${value} as shown`,
  notReached: (said: string, aim: string) => `${said}, ${aim} not reached`,
  toBe: (said: string, aim: string) => `${said}, to be ${aim}`,
  shadowsOnly: "shadows without caustics",
  lightCut: (percent: string) => `caustics lack at most ${percent} %`,
  meaning: (name: string, meaning: string) => `${name}: ${meaning}`,
  errorAsShown: "error as shown",
};

/** What the kinds of error are of. */
export const errors = {
  frontier:
    "What settings like this moving frame's miss of the default scene at 1280\u00d7720, as measured beforehand: " +
    "a single sample does not show its own error.",
  estimated: "What this picture at rest still misses, estimated from the two halves of its samples.",
  shown:
    "How far this picture is from a perfect one as a screen shows it, from 0 to 1, root mean square over pixels and " +
    "colours: what more samples would take away. From 0.004 on no difference is seen.",
};

/** What changed, for those who cannot see it. */
export const changes = {
  moving: (target: string) => `moving the ${target}`,
  noneChosen: "no stone chosen",
  chosen: (stone: string) => `${stone} chosen`,
  paused: { one: "the stone is paused", several: "the stones are paused" },
  atRest: { one: "the stone is at rest", several: "the stones are at rest" },
  falling: { one: "the stone falls", several: "the stones fall" },
  mirror: "mirror",
  checker: "checker",
  lightSky: "light sky",
  ownSky: "the scene's own sky",
  wallsShown: "walls shown",
  wallsHidden: "walls hidden",
  pinned: "quality pinned",
  unpinned: "quality follows the frame rate",
  nothingToUndo: "There is nothing to undo.",
  nothingToRedo: "There is nothing to redo.",
};

/** Where the stones are, if the picture shows none. */
export const whereabouts = {
  is: (who: string, where: string) => `${who} is ${where}.`,
  who: { one: "The stone", several: "The nearest stone" },
  behind: "behind the camera",
  above: "above the picture",
  below: "below the picture",
  left: "to the left of the picture",
  right: "to the right of the picture",
  remedy: { one: "P lets it fall.", several: "P lets them fall." },
  look: { one: "Look at it", several: "Look at them" },
};

/** The connection, and what stands in the way of the picture. */
export const connection = {
  connecting: "Connecting\u2026",
  lost: (next: string) => `Connection lost. ${next}`,
  closed: "Not connected.",
  closedHere: "closed by the page",
  notSent: "Not connected: nothing was sent.",
  notAnswered: "The server did not answer.",
  engineDown: "The render process stopped and is being restarted. The scene is kept.",
  leaving: (minutes: number) =>
    `This server is about to be stopped, within ${minutes} ${minutes === 1 ? "minute" : "minutes"}. Your session stays ` +
    "until then, and then this page takes it to the next server by itself.",
  waiting: "Waiting for the first picture\u2026",
  waitingLong:
    "Waiting for the first picture\u2026\nA server that is new to its processor first compiles its kernels for it, once.",
  regained: "The server had lost this session. It was made again as this page last saw it.",
  notRegained: "The server has lost this session, and it cannot be made again.",
  tryingAgain: (seconds: number) => `Trying again in ${seconds} s\u2026`,
  unknownSession: "There is no such session (any more). It may have been closed, or expired.",
  otherVersion: "This page and the server speak different versions. Reload the page.",
  foreignOrigin: "The server does not let this page watch: it was served from another origin.",
  ended: (reason: string) => `The stream ended: ${reason}`,
  endedByCode: (code: number) => `The stream ended (code ${code}).`,
  noSessionYet: "There is no session yet.",
  noId: (id: string) => `${id} is not the id of a session.`,
  needsToken:
    "This server asks for its token. Open the page by the address that culet printed when it was started: " +
    "it ends with #token= and the token.",
  notThere: "There is nothing to watch at this link (any more).",
  watching: "You watch this session. Whoever has the link to steer it moves things.",
  viewRefused: "This server cannot show the view of this link.",
  startAnew: "Start a new session",
  tryAgain: "Try again",
  tryNow: "Try now",
  unreachable: "The server cannot be reached.",
  answered: (status: number) => `The server answered with status ${status}.`,
  notUnderstood: (why: string) => `The server sent what this page does not understand: ${why}`,
  notDecoded: (picture: number, why: string) => `Picture ${picture} cannot be decoded: ${why}`,
  comeBack: "H, Esc or a tap on the picture brings everything back.",
  dismiss: "Dismiss",
};

/** Files, pictures and links, in and out. */
export const files = {
  picture: "Picture",
  copy: "Copy",
  copiedPicture: "picture",
  copiedLink: "link",
  clip: "Clip",
  lastSeconds: "last 10 s",
  nextSeconds: "next 10 s",
  scene: "Scene",
  save: "save",
  stop: "stop",
  open: "open",
  openRow: "Open",
  mesh: "mesh or design",
  sky: "sky",
  rendering: "Rendering the picture at full quality\u2026",
  pictureCopied: "The picture is on the clipboard.",
  linkCopied: "The link to this view is on the clipboard.",
  noScene: "There is no scene yet.",
  noPicture: "There is no picture yet.",
  reading: (name: string) => `Reading ${name}\u2026`,
  of: (name: string, said: string) => `${name}: ${said}`,
  found: (name: string, findings: string) => `${name}:\n${findings}`,
  notJson: (name: string, why: string) => `${name} is not JSON: ${why}`,
  list: "a list",
  noSceneIn: (name: string, got: string) => `${name}: expected a scene (a JSON object), got ${got}`,
  notToOpen: (name: string, scene: string, mesh: string, sky: string) =>
    `${name}: expected a scene (${scene}), a mesh or design (${mesh}) or a sky (${sky}).`,
  facets: (count: string, convex: boolean) => `${count} facets, ${convex ? "convex" : "not convex"}.`,
  pixels: (width: string, height: string) => `${width} \u00d7 ${height} pixels.`,
};

export const clip = {
  stopRecording: "Stop recording, and save the clip",
  recording: (seconds: number) => `Recording, for ${seconds} s at most\u2026`,
  stop: "Stop",
  making: "Making the clip\u2026",
  cancel: "Cancel",
  unable: "This browser makes no films: neither WebCodecs nor MediaRecorder is there. A screen recorder may do it.",
  failed: (why: string) => `The browser could not make the film (${why}).`,
};

export const clipboard = {
  insecurePicture:
    "The browser gives the clipboard only to pages that came by https, or from this machine: S saves the picture instead.",
  insecureText: (text: string) =>
    "The browser gives the clipboard only to pages that came by https, or from this machine. " +
    `To be copied by hand:\n${text}`,
  noPictures: "This browser copies no pictures: S saves the picture.",
  refusedPicture: (why: string) => `The browser did not let the page write to the clipboard (${why}). S saves it.`,
  refusedText: (why: string, text: string) =>
    `The browser did not let the page write to the clipboard (${why}). To be copied by hand:\n${text}`,
};

/** What an address asks for. */
export const address = {
  ui: (got: string) => `ui in the address: expected 0 or 1, got ${got}.`,
  rotate: (most: number, got: string) =>
    `rotate in the address: expected ${-most} to ${most} degrees a second, got ${got}.`,
  legend: (got: string) => `legend in the address: expected 0 or 1, got ${got}.`,
  background: (got: string) =>
    `background in the address: expected a colour of six hexadecimal digits such as f4f1ea, got ${got}.`,
  otherVersion: "This link is of another version of culet: it cannot be read.",
  damaged: "This link is damaged: a part of it is missing or changed. Copy it again, as a whole.",
  noScene: "This link is damaged: there is no scene in it.",
};

/** Of `<culet-viewer>`, in other pages. */
export const viewer = {
  alt: "A gemstone, live",
  noAddress: (got: string) => `src: expected the address of a server, got ${got}`,
};
