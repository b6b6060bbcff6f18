/** Names for parts of the protocol's unions. */

import type { Ack, ControlEvent, Orbit, Outline, Pick, Ping, Push, Resize, Visibility } from "@culet/protocol/messages";

export type { ControlEvent, Push };

/** What moves: the camera, one of the lights, or the stone that is chosen. */
export type Target = NonNullable<Orbit["target"]> | "stone";

/** What changes the session, for all its viewers. */
export type SessionEvent = Exclude<ControlEvent, Ack | Outline | Pick | Ping | Resize | Visibility>;
