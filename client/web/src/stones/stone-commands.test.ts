import { beforeEach, expect, it } from "vitest";
import type { SessionEvent } from "../session/events";
import { INITIAL, type ViewState } from "../session/view-state";
import { words } from "../words/words";
import { StoneCommands } from "./stone-commands";

const { chooseFirst: CHOOSE_FIRST, noStone: NO_STONE, nothingRemoved: NOTHING_REMOVED } = words.stones;
const NO_ROOM = words.stones.noRoom(64);

const RUBY = { id: "ruby", cut: "brilliant", scale: 1, position: [0, 0, 0] };
const GLASS = { id: "glass", cut: "brilliant", scale: 1, position: [3, 0, 0] };
let state: ViewState;
let sent: SessionEvent[];
let told: string[];
let commands: StoneCommands;

function scene(...stones: object[]): void {
  state = { ...state, scene: { stones } };
}

beforeEach(() => {
  [sent, told] = [[], []];
  state = INITIAL;
  scene(RUBY, GLASS);
  commands = new StoneCommands({
    state: () => state,
    send: (event) => sent.push(event),
    choose: (stone) => {
      state = { ...state, stone };
    },
    tell: (text) => told.push(text),
  });
});

it("adds another like the chosen one, or like the first, and chooses that", () => {
  commands.add();
  expect(state.stone).toBe("ruby-2");
  state = { ...state, stone: "glass" };
  commands.add();
  expect(sent[1]).toMatchObject({ type: "patch_scene", patch: { stones: { "glass-2": { id: "glass-2" } } } });
});

it("looks at the chosen stone, at all if none is, and says if there is none", () => {
  commands.lookAround();
  state = { ...state, stone: "glass" };
  commands.lookAround();
  expect(sent).toEqual([{ type: "look_at_stone" }, { type: "look_at_stone", stone: "glass" }]);
  scene();
  commands.lookAround();
  expect(told).toEqual([NO_STONE]);
  expect(sent).toHaveLength(2);
});

it("removes the chosen stone, and takes removals back one by one", () => {
  for (const id of ["ruby", "glass"]) {
    state = { ...state, stone: id };
    commands.remove();
  }
  scene();
  expect(commands.removals).toBe(2);
  commands.putBack();
  commands.putBack();
  expect(sent.map((event) => event.type === "patch_scene" && event.patch)).toEqual([
    { stones: { ruby: null } },
    { stones: { glass: null } },
    { stones: { glass: GLASS } },
    { stones: { ruby: RUBY } },
  ]);
  commands.putBack();
  expect(told).toEqual([NOTHING_REMOVED]);
});

it("takes no removal back that came back by itself, as by an undo", () => {
  state = { ...state, stone: "ruby" };
  commands.remove();
  expect(commands.removals).toBe(0); // not yet: the stone is there until the server has heard
  scene(GLASS);
  expect(commands.removals).toBe(1);
  scene(RUBY, GLASS);
  commands.putBack();
  expect(told).toEqual([NOTHING_REMOVED]);
});

it("removes no stone by guess, but the only one", () => {
  commands.remove();
  expect([told, sent]).toEqual([[CHOOSE_FIRST], []]);
  scene(GLASS);
  commands.remove();
  expect(sent).toEqual([{ type: "patch_scene", patch: { stones: { glass: null } } }]);
});

it("looks at, puts back and holds the chosen stone alone", () => {
  commands.look();
  expect([told, sent]).toEqual([[CHOOSE_FIRST], []]);
  commands.choose("glass");
  commands.look();
  commands.reset();
  commands.hold();
  expect(sent).toEqual([
    { type: "look_at_stone", stone: "glass" },
    { type: "reset_stone", stone: "glass" },
    { type: "toggle_fall", stone: "glass" },
  ]);
});

it("lets what it scatters fall, and goes on with what falls", () => {
  commands.scatter();
  state = { ...state, falling: true };
  commands.scatter();
  expect(sent.map(({ type }) => type)).toEqual(["patch_scene", "toggle_fall", "patch_scene"]);
});

it("keeps what cannot be put back for want of room", () => {
  scene(RUBY);
  commands.remove();
  scene(...Array.from({ length: 64 }, (_, k) => ({ ...GLASS, id: `${k}` })));
  commands.putBack();
  expect([told, commands.removals]).toEqual([[NO_ROOM], 1]);
});

it("says why there is nothing to do", () => {
  scene(...Array.from({ length: 64 }, (_, k) => ({ ...RUBY, id: `${k}` })));
  commands.add();
  scene();
  commands.scatter();
  commands.remove();
  expect([told, sent]).toEqual([[NO_ROOM, NO_STONE, NO_STONE], []]);
});

it("knows nothing of what was removed from another scene", () => {
  scene(RUBY);
  commands.remove();
  commands.forget();
  commands.putBack();
  expect(told).toEqual([NOTHING_REMOVED]);
});
