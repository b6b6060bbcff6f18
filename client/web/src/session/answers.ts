// Generated from the interface's description by "make format"; do not edit.

import type { JsonObject } from "@culet/protocol/messages";

export type Scene = JsonObject;

/**
 * Light of one colour, which is followed by itself.
 */
export interface Chain {
  wavelength: number | null;
  channel: ("red" | "green" | "blue") | null;
  /**
   * @minItems 3
   * @maxItems 3
   */
  colour: [number, number, number];
  indices: {
    [k: string]: number;
  };
}
/**
 * A named cut; `proportions` is the JSON schema of what it can be told, with what is `usual`.
 */
export interface Cut {
  name:
    | "brilliant"
    | "old-european"
    | "single"
    | "rose"
    | "portuguese"
    | "briolette"
    | "oval"
    | "cushion"
    | "pear"
    | "marquise"
    | "trillion"
    | "heart"
    | "princess"
    | "emerald"
    | "asscher"
    | "baguette";
  summary: string;
  proportions: Scene;
  title: string;
}
/**
 * All cuts.
 */
export interface Cuts {
  cuts: Cut[];
}
/**
 * A mesh in figures.
 */
export interface DescribedMesh {
  findings: string[];
  vertices: number;
  triangles: number;
  facets: number;
  convex: boolean;
  volume: number;
}
/**
 * A sky in figures.
 */
export interface DescribedSky {
  findings: string[];
  width: number;
  height: number;
  largest_radiance: number;
}
/**
 * What is left.
 */
export interface DrainAnswer {
  /**
   * After which the server ends at the latest.
   */
  seconds: number;
  /**
   * Who watch; the server ends before if nobody does any more.
   */
  viewers: number;
}
/**
 * What is known so far.
 */
export interface GradeReport {
  stone: string;
  index: number;
  size: Size;
  rules: Rules;
  grades: Grades;
  weighted_light_return?: Number | null;
  tilt?: {
    [k: string]: TiltPoint[];
  } | null;
  done?: number;
}
/**
 * Millimetres and carats.
 */
export interface Size {
  length: number;
  width: number;
  depth: number;
  carats: number;
  density: number;
}
/**
 * By default culet's own: chains are followed to the end.
 */
export interface Rules {
  head_degrees?: number;
  glare?: "all" | "crown" | "none";
  bounces?: number;
  cutoff?: number;
}
/**
 * Per cent, but where said otherwise.
 */
export interface Grades {
  iso: Number;
  cos: Number;
  sc2: Number;
  shares: {
    [k: string]: Number;
  };
  window: Number;
  extinction: Number;
  contrast: Number;
  fire: Number;
  fire_degrees: Number;
  rays: number;
}
/**
 * Of one grade.
 */
export interface Number {
  value: number;
  error: number;
  bound?: number;
}
/**
 * Of a tilt curve.
 */
export interface TiltPoint {
  degrees: number;
  iso: Number;
  cos: Number;
  sc2: Number;
}
/**
 * A way to follow a free rotation; `simulation.integrator` of a scene takes the name.
 */
export interface IntegratorDescription {
  name: string;
  summary: string;
  title: string;
}
/**
 * All integrators.
 */
export interface Integrators {
  integrators: IntegratorDescription[];
}
/**
 * What the server knows of a session without asking the engine.
 */
export interface ListedSession {
  /**
   * `DELETE /api/sessions/{id}` forgets the session.
   */
  id: string;
  /**
   * Whoever knows it may watch the session, no more.
   */
  watch: string;
  /**
   * Address of who opened the session.
   */
  client: string;
  viewers: number;
  stones: number;
  /**
   * Whether time goes on for the stones.
   */
  falling: boolean;
  /**
   * Whether all stones have come to rest for good.
   */
  asleep: boolean;
  /**
   * Since somebody watched it, or asked for it; 0 while watched.
   */
  unused_seconds: number;
}
/**
 * A named material: where its numbers come from, and how far they can be trusted.
 */
export interface Material {
  name: string;
  summary: string;
  source: string;
  confidence: "measured" | "weak source" | "as set";
  ray: "ordinary ray" | null;
  /**
   * @minItems 2
   * @maxItems 2
   */
  span_nm: [number, number];
  /**
   * @minItems 3
   * @maxItems 3
   */
  indices: [number, number, number];
  coloured: boolean;
  title: string;
}
/**
 * All named materials; `indices` are refractive indices at `nanometres`.
 */
export interface Materials {
  /**
   * @minItems 3
   * @maxItems 3
   */
  nanometres: [number, number, number];
  materials: Material[];
}
/**
 * An accepted mesh; `stones[0].mesh` of a scene takes the id.
 */
export interface MeshAnswer {
  id: string;
  description: DescribedMesh;
}
/**
 * Of the pixel's light: where it comes from.
 */
export interface Part {
  meets: "lamp" | "sky" | "head" | "backdrop" | "floor" | "left-wall" | "middle-wall" | "right-wall" | "cut" | "untold";
  number: number | null;
  side: ("above" | "below" | "left" | "right" | "ahead" | "behind") | null;
  /**
   * @minItems 3
   * @maxItems 3
   */
  light: [number, number, number];
  share: number;
}
/**
 * One chain at one step.
 */
export interface Pass {
  chain: number | null;
  /**
   * @minItems 3
   * @maxItems 3
   */
  start: [number, number, number];
  /**
   * @minItems 3
   * @maxItems 3
   */
  point: [number, number, number];
  /**
   * @minItems 3
   * @maxItems 3
   */
  direction: [number, number, number];
  weight_before: number;
  weight: number;
  cut: number;
  kept: number;
  /**
   * @minItems 3
   * @maxItems 3
   */
  light: [number, number, number];
  length?: number | null;
  incidence_degrees?: number | null;
  refraction_degrees?: number | null;
  critical_degrees?: number | null;
  reflectance?: Reflectance | null;
  polarisation?: number | null;
}
/**
 * Of a stone's surface at that angle.
 */
export interface Reflectance {
  s: number;
  p: number;
  unpolarised: number;
}
/**
 * All light of one pixel, in one sample, or of one ray.
 */
export interface Path {
  pixel: [number, number, number, number] | null;
  /**
   * @minItems 3
   * @maxItems 3
   */
  origin: [number, number, number];
  /**
   * @minItems 3
   * @maxItems 3
   */
  direction: [number, number, number];
  /**
   * @minItems 3
   * @maxItems 3
   */
  value: [number, number, number];
  cut: number;
  chains: Chain[];
  steps: Step[];
  parts: Part[];
  left_out: number;
  poses: {
    [k: string]: Pose;
  };
  polarised: boolean;
}
/**
 * One place in the tree of a pixel's light: the chains that go there are together still.
 */
export interface Step {
  number: number;
  parent: number | null;
  kind: "enters" | "meets" | "lands" | "sees" | "ends" | "chance";
  passes: Pass[];
  stone?: string | null;
  facet?: number | null;
  facet_name?: string | null;
  tier?: number | null;
  inside?: boolean;
  elevation_degrees?: number | null;
  parts?: Part[];
}
/**
 * Of a stone, in the world.
 */
export interface Pose {
  /**
   * @minItems 3
   * @maxItems 3
   */
  position: [number, number, number];
  /**
   * @minItems 4
   * @maxItems 4
   */
  orientation: [number, number, number, number];
  scale: number;
}
/**
 * A named scene.
 */
export interface Preset {
  name: string;
  summary: string;
  group: "diamonds" | "instruments" | "coloured stones" | "other cuts" | "several stones" | "the report";
  thumbnail: string;
  scene: Scene;
  title: string;
}
/**
 * All presets.
 */
export interface Presets {
  presets: Preset[];
}
/**
 * In the file's units; per cent are of the width.
 */
export interface Proportions {
  facets: number;
  corners: number;
  edges: number;
  length: number;
  width: number;
  height: number;
  volume: number;
  table_percent: number | null;
  crown_percent: number | null;
  girdle_percent: number | null;
  pavilion_percent: number | null;
}
/**
 * A session as it is now.
 */
export interface SessionAnswer {
  /**
   * Whoever knows it may watch and change the session. Of a session that was asked for by its watch id, that.
   */
  id: string;
  /**
   * Whoever knows it may watch the session, no more: it takes the id's place.
   */
  watch: string;
  scene: Scene;
  /**
   * Whether time goes on for the stones.
   */
  falling: boolean;
  /**
   * Whether all stones have come to rest for good.
   */
  asleep: boolean;
  /**
   * What each stone does, by its id.
   */
  motions: {
    [k: string]: "paused" | "falling" | "asleep";
  };
  /**
   * While things move: 0 is many frames, 1 few and good ones.
   */
  exactness: number;
  /**
   * Whether `exactness` fixes the quality of moving frames instead.
   */
  pinned: boolean;
  /**
   * Whether there is an edit that the event `undo` takes back.
   */
  can_undo: boolean;
  /**
   * Whether there is an undone edit that `redo` makes again.
   */
  can_redo: boolean;
  /**
   * What was found in uploaded meshes, and which stones overlap, a sentence each.
   */
  findings: string[];
  viewers: number;
  /**
   * Where the WebSocket is, relative to what was asked; see the protocol.
   */
  stream: string;
}
/**
 * The one that was used last first.
 */
export interface SessionList {
  sessions: ListedSession[];
}
/**
 * All named panoramas.
 */
export interface Skies {
  skies: Sky[];
}
/**
 * A named panorama; `environment.image` of a scene takes the name.
 */
export interface Sky {
  name: string;
  summary: string;
  title: string;
}
/**
 * An accepted sky; `environment.image` of a scene takes the id.
 */
export interface SkyAnswer {
  id: string;
  description: DescribedSky;
}
/**
 * A tier of sloping facets that are all of one angle.
 */
export interface TierAngle {
  tier: number;
  names: string[];
  facets: number;
  side: "crown" | "pavilion";
  degrees: number;
  independent: boolean;
  least: number;
  most: number;
}
/**
 * The sloping tiers of a stone, in their order of cutting.
 */
export interface Tiers {
  tiers: TierAngle[];
}
