/** What a decoder is configured with: the name of a codec with its profile and level. */

export type VideoCodec = "h264" | "vp9";

/** 4:4:4 with 8 bits, of any size that a frame may have. */
const VP9 = "vp09.01.62.08.03";
const PARAMETER_SET = 7;

/**
 * Of a key frame. H.264 says its profile and level in the parameter set that each key frame has with it; Safari wants
 * just these. Null without a parameter set: it is no key frame.
 */
export function codecString(codec: VideoCodec, key: Uint8Array): string | null {
  if (codec === "vp9") return VP9;
  for (let at = 0; at + 6 < key.length; at += 1) {
    const starts = key[at] === 0 && key[at + 1] === 0 && key[at + 2] === 1;
    if (!starts || ((key[at + 3] ?? 0) & 31) !== PARAMETER_SET) continue;
    const digits = Array.from(key.subarray(at + 4, at + 7), (byte) => byte.toString(16).padStart(2, "0"));
    return `avc1.${digits.join("").toUpperCase()}`;
  }
  return null;
}
