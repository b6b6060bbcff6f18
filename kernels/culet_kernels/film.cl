// From sums of linear radiance to what a screen shows: three bytes a pixel. optics/tone.py and optics/gamut.py are the
// references, in double precision.
#include "lanes.cl"

// Kinds of tone map.
#define TONE_NONE 0
#define TONE_SRGB 1
#define TONE_CLASSIC 2
#define TONE_FILMIC 3
#define TONE_NEUTRAL 4

#define BLOCK 16 // pixels that are shown together

typedef struct {
  float16 red, green, blue;
} rgb16;

// Logarithm and power of 2 by polynomials through Chebyshev's points, within 2e-7 and, of the value, 1e-7; of numbers above 0,
// and of exponents above -127. PoCL's native ones take one lane after the other.
static inline float16 log2_near(float16 x) {
  const int16 bits = as_int16(x);
  const float16 t = as_float16((bits & 0x7fffff) | 0x3f800000) - 1; // from 0 to 1
  float16 sum = -0.012077020f;
  sum = fma(sum, t, (float16)(0.062748434f));
  sum = fma(sum, t, (float16)(-0.154152006f));
  sum = fma(sum, t, (float16)(0.255176349f));
  sum = fma(sum, t, (float16)(-0.353096353f));
  sum = fma(sum, t, (float16)(0.480012461f));
  sum = fma(sum, t, (float16)(-0.721306757f));
  sum = fma(sum, t, (float16)(1.442694725f));
  return fma(sum, t, convert_float16((bits >> 23) - 127));
}

static inline float16 exp2_near(float16 x) {
  const int16 power = convert_int16(x + 127); // of what is positive that is the whole part
  const float16 t = x - convert_float16(power - 127);
  float16 sum = 0.001893754f;
  sum = fma(sum, t, (float16)(0.008949590f));
  sum = fma(sum, t, (float16)(0.055860337f));
  sum = fma(sum, t, (float16)(0.240141818f));
  sum = fma(sum, t, (float16)(0.693154490f));
  sum = fma(sum, t, (float16)(0.999999898f));
  return sum * as_float16(power << 23);
}

// x to the power p, for x from 0 to 8, to well within half a level of 8 bits.
static inline float16 to_power(float16 x, float p) { return exp2_near(p * log2_near(fmax(x, 1e-9f))); }

static inline float16 encode_srgb(float16 x) { // IEC 61966-2-1
  return select(1.055f * to_power(x, 1 / 2.4f) - 0.055f, 12.92f * x, x <= 0.0031308f);
}

static inline float16 luminance(rgb16 c) { return 0.212639f * c.red + 0.715169f * c.green + 0.072192f * c.blue; }

static inline rgb16 mix_rgb(float16 grey, float16 saturation, rgb16 c) {
  const rgb16 mixed = {grey + saturation * (c.red - grey), grey + saturation * (c.green - grey),
                       grey + saturation * (c.blue - grey)};
  return mixed;
}

// Towards the grey of its luminance, until every component is from 0 to the ceiling.
static inline rgb16 desaturate(rgb16 c, float ceiling) {
  const float16 grey = clamp(luminance(c), 0.0f, ceiling);
  const float16 lowest = fmin(c.red, fmin(c.green, c.blue)), highest = fmax(c.red, fmax(c.green, c.blue));
  const float16 from_below = select((float16)(1), grey / fmax(grey - lowest, 1e-20f), lowest < 0);
  const float16 from_above = select((float16)(1), (ceiling - grey) / fmax(highest - grey, 1e-20f), highest > ceiling);
  return mix_rgb(grey, fmin(from_below, from_above), c);
}

// J. Hable, Filmic Tonemapping Operators (2010), with its exposure of 2 before the curve.
static inline float16 hable(float16 x) {
  return (x * (0.15f * x + 0.05f) + 0.004f) / (x * (0.15f * x + 0.5f) + 0.06f) - 0.02f / 0.30f;
}
#define LINEAR_WHITE 11.2f

static inline rgb16 filmic(rgb16 c) {
  c = desaturate(c, 1e20f);
  const float16 before = luminance(c), after = fmax(hable(fmin(2 * before, LINEAR_WHITE)) / hable(LINEAR_WHITE), 0.0f);
  const float16 scale = select((float16)(0), after / fmax(before, 1e-20f), before > 0);
  const rgb16 scaled = {scale * c.red, scale * c.green, scale * c.blue};
  return desaturate(scaled, 1);
}

// Khronos PBR Neutral (2024) without its offset: up to COMPRESSED as it is; above that the largest component comes ever
// nearer to 1, and the colour goes to white as far as it is held back.
#define COMPRESSED 0.8f
#define WHITENING 0.15f
static inline rgb16 neutral(rgb16 c) {
  const rgb16 kept = {fmax(c.red, 0.0f), fmax(c.green, 0.0f), fmax(c.blue, 0.0f)};
  const float16 peak = fmax(kept.red, fmax(kept.green, kept.blue));
  if (!any(peak > COMPRESSED)) return kept; // as most blocks are
  const float room = 1 - COMPRESSED;
  const float16 above = fmax(peak - COMPRESSED, 0.0f), lowered = COMPRESSED + above * room / (above + room);
  const float16 scale = select((float16)(1), lowered / fmax(peak, 1e-20f), peak > COMPRESSED);
  const float16 held_back = select((float16)(0), peak - lowered, peak > COMPRESSED);
  const float16 colour = 1 / (WHITENING * held_back + 1);
  const rgb16 scaled = {scale * kept.red, scale * kept.green, scale * kept.blue};
  return mix_rgb(select(scaled.red, lowered, peak > COMPRESSED), colour, scaled);
}

static inline float16 shown(float16 x, int tone_map) {
  const float16 inside = clamp(x, 0.0f, 4.0f);
  if (tone_map == TONE_SRGB || tone_map == TONE_FILMIC || tone_map == TONE_NEUTRAL) return encode_srgb(inside);
  if (tone_map == TONE_CLASSIC) return to_power(1.2f * inside, 1.2f); // the report's
  return inside;
}

// Radiance times exposure as a screen shows it; `inside_gamut` says that no component is negative, or that those that are may
// be clipped. What is above 1 is clipped by who takes it.
static inline rgb16 developed(rgb16 colour, int tone_map, int inside_gamut) {
  if (!inside_gamut) colour = desaturate(colour, 1e20f);
  if (tone_map == TONE_FILMIC) colour = filmic(colour);
  if (tone_map == TONE_NEUTRAL) colour = neutral(colour);
  const rgb16 result = {shown(colour.red, tone_map), shown(colour.green, tone_map), shown(colour.blue, tone_map)};
  return result;
}

// Levels from 0 to 255, to the nearest, and to the even one of two that are as near: the sum's last bits are they. PoCL's
// conversion takes one lane after the other.
#define LAST_BITS 12582912.0f // 1.5 x 2^23: the least step of numbers there is 1
static inline uchar16 to_bytes(float16 x) {
  return convert_uchar16(as_int16(clamp(255 * x, 0.0f, 255.0f) + LAST_BITS) & 0xff);
}

// Which sums of samples there are besides the earlier run.
#define LATER 1
#define ASIDE 2

// The sums of four pixels, one after the other.
static inline float16 four_pixels(__global const real4 *sums) {
  return (float16)(convert_float4(sums[0]), convert_float4(sums[1]), convert_float4(sums[2]), convert_float4(sums[3]));
}

static inline rgb16 block_of(__global const real4 *earlier, __global const real4 *later, __global const real4 *aside,
                             int runs) {
  float16 four[4];
  for (int k = 0; k < 4; k++) {
    four[k] = four_pixels(earlier + 4 * k);
    if (runs & LATER) four[k] += four_pixels(later + 4 * k);
    if (runs & ASIDE) four[k] += four_pixels(aside + 4 * k);
  }
  const rgb16 sums = {(float16)(four[0].s048c, four[1].s048c, four[2].s048c, four[3].s048c),
                      (float16)(four[0].s159d, four[1].s159d, four[2].s159d, four[3].s159d),
                      (float16)(four[0].s26ae, four[1].s26ae, four[2].s26ae, four[3].s26ae)};
  return sums;
}

// The same where a picture ends within a block: the last pixel is repeated.
static inline rgb16 part_of_block(__global const real4 *earlier, __global const real4 *later,
                                  __global const real4 *aside, int runs, int count) {
  float linear[3][BLOCK];
  for (int i = 0; i < BLOCK; i++) {
    const int pixel = min(i, count - 1);
    real4 all = earlier[pixel];
    if (runs & LATER) all += later[pixel];
    if (runs & ASIDE) all += aside[pixel];
    const float4 sum = convert_float4(all);
    linear[0][i] = sum.x;
    linear[1][i] = sum.y;
    linear[2][i] = sum.z;
  }
  const rgb16 sums = {vload16(0, linear[0]), vload16(0, linear[1]), vload16(0, linear[2])};
  return sums;
}

// A block's bytes, pixel by pixel.
static inline void store_block(uchar16 r, uchar16 g, uchar16 b, __global uchar *to) {
  const uchar16 first = (uchar16)(r.s0, g.s0, b.s0, r.s1, g.s1, b.s1, r.s2, g.s2, b.s2, r.s3, g.s3, b.s3, r.s4, g.s4,
                                  b.s4, r.s5),
                second = (uchar16)(g.s5, b.s5, r.s6, g.s6, b.s6, r.s7, g.s7, b.s7, r.s8, g.s8, b.s8, r.s9, g.s9, b.s9,
                                   r.sa, g.sa),
                third = (uchar16)(b.sa, r.sb, g.sb, b.sb, r.sc, g.sc, b.sc, r.sd, g.sd, b.sd, r.se, g.se, b.se, r.sf,
                                  g.sf, b.sf);
  vstore16(first, 0, to);
  vstore16(second, 1, to);
  vstore16(third, 2, to);
}

// A work-item shows BLOCK of the pixels from `begin` to before `end`, of which `earlier` and, if `runs` says so, `later` and
// `aside` hold sums of samples. `scale` is the exposure over the number of samples.
__kernel void develop(__global const real4 *earlier, __global const real4 *later, __global const real4 *aside, int runs,
                      __global uchar *bytes, int begin, int end, float scale, int tone_map, int inside_gamut) {
  const int first = begin + get_global_id(0) * BLOCK, count = min(BLOCK, end - first);
  if (count <= 0) return;
  __global const real4 *before = earlier + first, *after = later + first, *beside = aside + first;
  rgb16 radiance =
      count == BLOCK ? block_of(before, after, beside, runs) : part_of_block(before, after, beside, runs, count);
  radiance.red *= scale;
  radiance.green *= scale;
  radiance.blue *= scale;
  const rgb16 colour = developed(radiance, tone_map, inside_gamut);
  const uchar16 red = to_bytes(colour.red), green = to_bytes(colour.green), blue = to_bytes(colour.blue);
  if (count == BLOCK) {
    store_block(red, green, blue, bytes + 3 * first);
    return;
  }
  uchar out[3][BLOCK];
  vstore16(red, 0, out[0]);
  vstore16(green, 0, out[1]);
  vstore16(blue, 0, out[2]);
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) bytes[3 * (first + i) + k] = out[k][i];
}

// The samples of one run, times `scale`.
static inline rgb16 scaled(__global const real4 *sums, int first, int count, float scale) {
  __global const real4 *from = sums + first;
  rgb16 result = count == BLOCK ? block_of(from, from, from, 0) : part_of_block(from, from, from, 0, count);
  result.red *= scale;
  result.green *= scale;
  result.blue *= scale;
  return result;
}

static inline float16 squared_difference(float16 a, float16 b) {
  const float16 difference = clamp(a, 0.0f, 1.0f) - clamp(b, 0.0f, 1.0f);
  return difference * difference;
}

// How far two runs of samples are apart on a screen, from pixel `begin` to before `end`: of each work-item's `block` pixels the
// sum over pixels and components, from 0 to 1, of the squared differences. `scale` is the exposure over each run's samples.
__kernel void apart_as_shown(__global const real4 *earlier, __global const real4 *later, __global float *apart,
                             int block, int begin, int end, float scale, int tone_map, int inside_gamut) {
  const int first = begin + get_global_id(0) * block, last = min(first + block, end);
  const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  float16 sums = 0;
  for (int pixel = first; pixel < last; pixel += BLOCK) {
    const int count = min(BLOCK, last - pixel);
    const rgb16 a = developed(scaled(earlier, pixel, count, scale), tone_map, inside_gamut);
    const rgb16 b = developed(scaled(later, pixel, count, scale), tone_map, inside_gamut);
    const float16 squared =
        squared_difference(a.red, b.red) + squared_difference(a.green, b.green) + squared_difference(a.blue, b.blue);
    sums += select((float16)(0), squared, lane < count);
  }
  const float8 eight = sums.lo + sums.hi;
  const float4 four = eight.lo + eight.hi;
  apart[get_global_id(0)] = four.x + four.y + four.z + four.w;
}

#define RGB 3

// The mean of the byte at `at` and of those of the pixels beside it, 1 : 6 : 1, times 8.
static inline ushort16 across(__global const uchar *bytes, int at) {
  return convert_ushort16(vload16(0, bytes + at - RGB)) + convert_ushort16(vload16(0, bytes + at + RGB)) +
         (ushort16)(6) * convert_ushort16(vload16(0, bytes + at));
}

// The same of one byte of a row; at its ends the pixel itself stands for the one that is not there.
static inline ushort across_one(__global const uchar *row, int x, int width) {
  return row[x < RGB ? x : x - RGB] + row[x >= width - RGB ? x : x + RGB] + 6 * row[x];
}

// A developed picture of `rows` rows of `width` bytes, filtered by (1 6 1)/8 along both axes: a work-item a row.
__kernel void soften(__global const uchar *bytes, __global uchar *softened, int width, int rows) {
  const int row = get_global_id(0);
  if (row >= rows) return;
  __global const uchar *own = bytes + (size_t)row * width;
  __global const uchar *above = row > 0 ? own - width : own, *below = row < rows - 1 ? own + width : own;
  __global uchar *to = softened + (size_t)row * width;
  int x = RGB;
  for (; x + BLOCK + RGB <= width; x += BLOCK) {
    const ushort16 sum = across(above, x) + across(below, x) + (ushort16)(6) * across(own, x);
    vstore16(convert_uchar16((sum + (ushort16)(32)) >> (ushort16)(6)), 0, to + x);
  }
  for (int k = 0; k < width; k = k == RGB - 1 ? x : k + 1) {
    const ushort sum = across_one(above, k, width) + across_one(below, k, width) + 6 * across_one(own, k, width);
    to[k] = (sum + 32) >> 6;
  }
}
