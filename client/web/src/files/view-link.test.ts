import { describe, expect, it, test } from "vitest";
import { fitted, LinkError, packedView, unpackedView, viewAddress } from "./view-link";

const SCENE = {
  version: 2,
  camera: { kind: "pinhole", position: [0, 0, 12.345678901234567], target: [0, 0, 0], fov_degrees: 13.5 },
  stones: [{ id: "stone", position: [0, -0.373345, 0], note: "\u00e9\u{1f48e}" }],
};
const VIEW = { scene: SCENE, aspect: 1.6 };
const PAGE = "https://gems.example/?session=0123456789abcdef0123456789abcdef";

async function packed(view: object): Promise<string> {
  const found = packedView(new URL(await viewAddress(view as typeof VIEW, PAGE)).hash);
  if (found === null) throw new Error("expected a view in the address");
  return found;
}

async function refusal(text: string): Promise<string> {
  const error = await unpackedView(text).then(
    () => null,
    (thrown: unknown) => thrown,
  );
  expect(error).toBeInstanceOf(LinkError);
  return (error as LinkError).message;
}

describe("a link to a view", () => {
  it("holds the whole scene and the picture's shape, to the last bit", async () => {
    expect(await unpackedView(await packed(VIEW))).toEqual(VIEW);
  });

  it("is of the page's server, names no session, and is made of letters that mail and chat leave alone", async () => {
    expect(await viewAddress(VIEW, PAGE)).toMatch(/^https:\/\/gems\.example\/#view=1\.[\w-]+$/);
  });

  it("that is cut short, or changed, says that it is damaged", async () => {
    const whole = await packed(VIEW);
    for (const broken of [whole.slice(0, -20), `${whole.slice(0, 40)}!${whole.slice(41)}`, "1.", "1.AAAA"]) {
      expect(await refusal(broken)).toMatch(/damaged/);
    }
  });

  it("of another form says so", async () => {
    expect(await refusal("2.AAAA")).toMatch(/another version/);
    expect(await refusal("")).toMatch(/another version/);
  });

  it.each([{}, { scene: null }, { scene: [] }, { scene: "x" }, []])("without a scene, %j, says so", async (view) => {
    expect(await refusal(await packed(view))).toMatch(/no scene/);
  });

  it("that would unpack to more than a server takes is refused", async () => {
    expect(await refusal(await packed({ scene: { note: "a".repeat(2 ** 20) } }))).toMatch(/damaged/);
  });
});

test("other addresses hold no view", () => {
  expect(packedView("")).toBeNull();
  expect(packedView("#panel")).toBeNull();
});

test("a picture as wide as the one that was linked shows the same, and only a narrower one is seen from farther off", () => {
  const distance = (aspect: number) => {
    const { camera } = fitted(VIEW, aspect) as typeof SCENE;
    return camera.position[2];
  };
  expect(fitted(VIEW, 1.6)).toBe(SCENE);
  expect(fitted(VIEW, 2.4)).toBe(SCENE);
  expect(fitted({ ...VIEW, aspect: 0.46 }, 0.46)).toBe(SCENE);
  expect(distance(0.35)).toBeCloseTo(2 * 12.345678901234567); // half of the 0.7 that a stone needs
});
