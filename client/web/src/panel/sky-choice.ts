/** Another sky for the scene, so that it is seen: behind a studio's backdrop and floor nothing of it would show. */

import type { JsonObject } from "@culet/protocol/messages";
import { list, part } from "../json";

const IMAGE = "image:";

/** The sky of an image, by its name or the id of an upload. */
export function imageSky(image: string): string {
  return IMAGE + image;
}

function pointsOf(scene: JsonObject | null): JsonObject[] {
  return list(scene?.emitters).filter(({ shape }) => shape === "point");
}

function lampsOf(scene: JsonObject | null): JsonObject[] {
  return list(scene?.emitters).filter(({ shape }) => shape !== "point");
}

/**
 * The merge patch for a sky, which takes away what hides it, as the server's key for the light sky does. A panorama has a
 * ground of its own; the others are seen in a mirror, where the studio's floor was.
 */
export function skyPatch(scene: JsonObject | null, sky: string): JsonObject {
  const environment = sky.startsWith(IMAGE) ? { kind: "image", image: sky.slice(IMAGE.length) } : { kind: sky };
  if (sky === "studio") return { environment };
  const bare = (part(scene, "backdrop").kind ?? "none") === "none";
  const floor = { kind: sky.startsWith(IMAGE) ? "none" : "mirror" };
  return {
    environment,
    ...(bare ? {} : { backdrop: { kind: "none" } }),
    ...(part(scene, "floor").kind === "studio" ? { floor } : {}),
  };
}

/** Remembers the studio that a scene had, and gives it back with its lamps, backdrop and floor. */
export class SkyChoice {
  private studio: JsonObject | null = null;

  /** The scene as it is now. */
  see(scene: JsonObject | null): void {
    if (part(scene, "environment").kind !== "studio" || !scene) return;
    const { environment, emitters, backdrop, floor } = scene;
    this.studio = { environment, emitters: emitters ?? [], backdrop, floor };
  }

  /** Another scene comes, with which the studio has nothing to do. */
  forget(): void {
    this.studio = null;
  }

  patch(scene: JsonObject | null, sky: string): JsonObject {
    const back = this.backPatch(scene);
    if (sky === "studio") return back ?? skyPatch(scene, sky);
    return skyPatch({ ...scene, ...back }, sky);
  }

  /** What was put in place of the studio's backdrop and floor since is left. */
  private backPatch(scene: JsonObject | null): JsonObject | null {
    if (!this.studio) return null;
    const { environment, backdrop, floor } = this.studio;
    const bare = part(scene, "backdrop").kind === "none";
    const ours = ["none", "mirror"].includes(String(part(scene, "floor").kind));
    const lamps = lampsOf(this.studio);
    return {
      environment,
      ...(lamps.length > 0 && lampsOf(scene).length === 0 ? { emitters: [...pointsOf(scene), ...lamps] } : {}),
      ...(bare ? { backdrop } : {}),
      ...(ours && part(this.studio, "floor").kind === "studio" ? { floor } : {}),
    };
  }
}
