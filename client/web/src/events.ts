/** Names for parts of the protocol's unions. */

import type {
  Ack,
  ControlEvent,
  Dolly,
  Orbit,
  Outline,
  Pick,
  Ping,
  Push,
  Resize,
  Translate,
  Visibility,
} from "@culet/protocol/messages";

export type { ControlEvent, Dolly, Orbit, Push, Translate };

/** What moves: the camera or one of the lights. */
export type Target = NonNullable<Orbit["target"]>;

/** What changes the session, for all its viewers. */
export type SessionEvent = Exclude<ControlEvent, Ack | Outline | Pick | Ping | Resize | Visibility>;
