import { expect, it } from "vitest";
import { framed, framingPatch } from "./framing";

const SCENE = { camera: { position: [0, 2, 4], target: [0, 1, 0] } };

it.each([0.7, 1, 16 / 9])("leaves the camera where it is for a picture of %d", (aspect) => {
  expect(framingPatch(SCENE, aspect)).toBeNull();
});

it("takes it farther off along its line of sight, the more so the narrower the picture is", () => {
  expect(framingPatch(SCENE, 0.35)).toEqual({ camera: { position: [0, 3, 8] } });
  expect(framingPatch(SCENE, 0.175)).toEqual({ camera: { position: [0, 5, 16] } });
});

it("shows more of a scene with parallel rays, which look the same from farther off", () => {
  const camera = { ...SCENE.camera, kind: "orthographic", height: 2.4 };
  expect(framingPatch({ camera }, 0.35)).toEqual({ camera: { height: 4.8 } });
  expect(framed({ camera, floor: {} }, 0.35)).toEqual({ camera: { ...camera, height: 4.8 }, floor: {} });
  expect(framed({ camera }, 1)).toEqual({ camera });
});

it.each([null, {}, { camera: { position: "here", target: [0, 0, 0] } }])("survives %j", (scene) => {
  expect(framingPatch(scene, 0.5)).toBeNull();
});
