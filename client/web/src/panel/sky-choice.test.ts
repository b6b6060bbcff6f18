import { expect, it } from "vitest";
import { imageSky, SkyChoice, skyPatch } from "./sky-choice";

const STUDIO = { kind: "studio" };
const POINT = { shape: "point" };
const EMITTERS = [POINT, { shape: "box" }];
const BACKDROP = { kind: "gradient", centre: [1, 1, 1] };
const FLOOR = { kind: "studio", shadow: 0.5 };
const SCENE = { environment: STUDIO, emitters: EMITTERS, backdrop: BACKDROP, floor: FLOOR };
const BARE = { kind: "none" };

it("is seen: backdrop and studio floor go", () => {
  const image = { kind: "image", image: "a1" };
  expect(skyPatch(SCENE, imageSky("a1"))).toEqual({ environment: image, backdrop: BARE, floor: BARE });
  expect(skyPatch(SCENE, "light")).toEqual({
    environment: { kind: "light" },
    backdrop: BARE,
    floor: { kind: "mirror" },
  });
});

it.each([
  { ...SCENE, backdrop: BARE, floor: { kind: "matte" } },
  { environment: { kind: "dark" }, floor: { kind: "mirror" } },
  null,
])("changes nothing else of a scene that hides no sky", (scene) => {
  expect(skyPatch(scene, "half")).toEqual({ environment: { kind: "half" } });
});

it("goes back to the studio's lamps, backdrop and floor", () => {
  const choice = new SkyChoice();
  choice.see(SCENE);
  const away = { ...SCENE, ...choice.patch(SCENE, imageSky("aset")), emitters: [POINT] }; // as the server does
  choice.see(away);
  const light = { ...away, ...choice.patch(away, "light") };
  expect(light.floor).toEqual({ kind: "mirror" });
  expect(choice.patch(light, "studio")).toEqual(SCENE);
});

it("leaves what was put in the place of backdrop and floor since", () => {
  const choice = new SkyChoice();
  choice.see(SCENE);
  const changed = {
    environment: { kind: "light" },
    emitters: [{ shape: "round" }],
    backdrop: { kind: "plain" },
    floor: { kind: "matte" },
  };
  expect(choice.patch(changed, "studio")).toEqual({ environment: STUDIO });
});

it("knows nothing of the studio of another scene", () => {
  const choice = new SkyChoice();
  choice.see(SCENE);
  choice.forget();
  expect(choice.patch({ floor: BARE, backdrop: BARE }, "studio")).toEqual({ environment: { kind: "studio" } });
});
