// From sums of linear radiance to what a screen shows: three bytes a pixel.
#include "lanes.cl"

// Kinds of tone map.
#define TONE_NONE 0
#define TONE_SRGB 1
#define TONE_CLASSIC 2

#define BLOCK 16 // pixels that are shown together

// x to the power p, for x from 0 to 8, within half a level of 8 bits: exp2 and log2 of the processor's own width.
static inline float16 power(float16 x, float p) { return native_exp2(p * native_log2(fmax(x, 1e-9f))); }

static inline float16 shown(float16 radiance, int tone_map) {
  const float16 x = clamp(radiance, 0.0f, 4.0f);
  if (tone_map == TONE_SRGB) // IEC 61966-2-1
    return select(1.055f * power(x, 1 / 2.4f) - 0.055f, 12.92f * x, x <= 0.0031308f);
  if (tone_map == TONE_CLASSIC) return power(1.2f * x, 1.2f); // the report's
  return x;
}

static inline uchar16 to_bytes(float16 radiance, int tone_map) {
  return convert_uchar16_sat_rte(255 * shown(radiance, tone_map));
}

// A work-item shows BLOCK pixels. `scale` is the exposure over the number of samples.
__kernel void develop(__global const real4 *image, __global uchar *bytes, int pixels, float scale, int tone_map) {
  const int first = get_global_id(0) * BLOCK, count = min(BLOCK, pixels - first);
  float red[BLOCK], green[BLOCK], blue[BLOCK];
  for (int i = 0; i < BLOCK; i++) {
    const float4 sum = convert_float4(image[first + min(i, count - 1)]);
    red[i] = scale * sum.x;
    green[i] = scale * sum.y;
    blue[i] = scale * sum.z;
  }
  uchar out[3][BLOCK];
  vstore16(to_bytes(vload16(0, red), tone_map), 0, out[0]);
  vstore16(to_bytes(vload16(0, green), tone_map), 0, out[1]);
  vstore16(to_bytes(vload16(0, blue), tone_map), 0, out[2]);
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) bytes[3 * (first + i) + k] = out[k][i];
}
