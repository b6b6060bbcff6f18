import { expect, it } from "vitest";
import { part, triple } from "../json";
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

it("makes room for all stones that a wide picture frames", () => {
  const camera = { position: [0, 0, 10], target: [0, 0, 0], fov_degrees: 90 };
  const stones = [
    { id: "left", position: [-9, 0, 0], scale: 1 },
    { id: "beyond", position: [30, 0, 0], scale: 1 },
    { id: "behind", position: [0, 0, 20], scale: 1 },
  ];
  // 9 R and a radius are half the height at 10 R
  expect(framingPatch({ camera, stones }, 1.01)).toBeNull();
  const { position } = part(framingPatch({ camera, stones }, 0.5), "camera");
  expect(triple(position)?.[2]).toBeCloseTo(20, 9);
  const parallel = { ...camera, kind: "orthographic", height: 20 };
  expect(framingPatch({ camera: parallel, stones }, 0.5)).toEqual({ camera: { height: 40 } });
});

it.each([null, {}, { camera: { position: "here", target: [0, 0, 0] } }])("survives %j", (scene) => {
  expect(framingPatch(scene, 0.5)).toBeNull();
});
