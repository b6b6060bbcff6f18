// Radiance from infinity, and radiance by channel.
#ifndef CULET_SKY
#define CULET_SKY
#include "features.cl"
#include "world.cl"

// Radiance in up to three channels. Which ones, `channels_t` says: all three, or the one of a dispersed chain; its count
// is known at compile time wherever it matters, so that the channels left out cost nothing.
// With one lane in single precision it would be 12 bytes, which PoCL 3.1 (LLVM 15) returns in registers, and loses.
#define RADIANCE_CHANNELS (LANES == 1 ? 5 : 3)
typedef struct {
  realL channel[RADIANCE_CHANNELS];
} radianceL;

typedef struct {
  int first, count;
} channels_t;

#define EACH_CHANNEL(k, channels)                                                                                      \
  EACH (k, 3)                                                                                                          \
    if (k < (channels).count)

static inline channels_t all_channels(void) {
  const channels_t channels = {0, 3};
  return channels;
}

static inline radianceL black(void) {
  const radianceL none = {{splat(0), splat(0), splat(0)}};
  return none;
}

// The angle of a vector (x, y) from the x axis, in radians. In single precision by the polynomial 4.4.49 of M. Abramowitz and
// I. A. Stegun, Handbook of Mathematical Functions (1964), within 2e-8: the library's takes longer than all else here.
static inline realL angle_of(realL y, realL x) {
#if IS_DOUBLE
  return atan2(y, x);
#else
  const realL width = fabs(x), height = fabs(y);
  const realL ratio = fmin(width, height) / fmax(fmax(width, height), splat(1e-30f)), z = ratio * ratio;
  realL sum = splat(0.0028662257f);
  sum = fma(sum, z, splat(-0.0161657367f));
  sum = fma(sum, z, splat(0.0429096138f));
  sum = fma(sum, z, splat(-0.0752896400f));
  sum = fma(sum, z, splat(0.1065626393f));
  sum = fma(sum, z, splat(-0.1420889944f));
  sum = fma(sum, z, splat(0.1999355085f));
  sum = fma(sum, z, splat(-0.3333314528f));
  const realL within = fma(ratio * z, sum, ratio);
  const realL steep = blend(height > width, M_PI_2_F - within, within);
  const realL upper = blend(x < 0, M_PI_F - steep, steep);
  return blend(y < 0, -upper, upper);
#endif
}

// The panorama in a direction, between its four nearest pixels. The zenith is its upper edge, -z its left one, and +x is a
// quarter of the way to the right; it goes round, and at the poles a row looks across to its other half.
static inline radianceL panorama(world_t world, vec3L direction, channels_t channels) {
  const int width = world.scene->panorama_width, height = world.scene->panorama_height;
  const realL across = sqrt(fma(direction.x, direction.x, direction.z * direction.z));
  const realL turn = angle_of(direction.x, -direction.z) * (real)M_1_PI_F * (real)0.5 - world.scene->panorama_turn;
  const realL u = (turn - floor_lanes(turn)) * width - (real)0.5,
              v = angle_of(across, direction.y) * (real)M_1_PI_F * height - (real)0.5;
  const realL left = floor_lanes(u), upper = floor_lanes(v);
  const realL share_right = u - left, share_lower = v - upper;
  radianceL seen = black();
  EACH (corner, 4) {
    const int right = corner & 1, lower = corner >> 1;
    const intL row = reals_to_int(upper) + lower, inside = clamp(row, (intL)(0), (intL)(height - 1));
    intL column = reals_to_int(left) + right + blend_ints(row != inside, (intL)(width / 2), (intL)(0));
    column = blend_ints(column < 0, column + width, column);
    column = blend_ints(column >= width, column - width, column);
    int place[LANES];
    store_ints(3 * (inside * width + column) + channels.first, place);
    const realL share = (right ? share_right : (real)1 - share_right) * (lower ? share_lower : (real)1 - share_lower);
    EACH_CHANNEL (k, channels) {
      real pixel[LANES];
      for (int lane = 0; lane < LANES; lane++) pixel[lane] = world.panorama[place[lane] + k];
      seen.channel[k] = fma(share, load_lanes(pixel), seen.channel[k]);
    }
  }
  EACH_CHANNEL (k, channels) seen.channel[k] *= world.scene->panorama_scale;
  return seen;
}

// A box is what lies between four planes through the eye, and its share rises with the distances to them: to the edges
// across it is sin(half width) (way to the box) - cos(half width) |way across|, here in units of how far it fades.
static inline void add_boxes(__constant const parameters_t *scene, vec3L direction, channels_t channels,
                             radianceL *radiance) {
  for (int i = 0; i < scene->boxes; i++) {
    realL way[3]; // how far the direction goes to the box, across and up
    EACH (k, 3)
      way[k] = fma(direction.x, splat(scene->box[i][k][0]),
                   fma(direction.y, splat(scene->box[i][k][1]), direction.z * scene->box[i][k][2]));
    const realL across = clamp(scene->box_edge[i][0] * way[0] - fabs(way[1]), (realL)0, (realL)1);
    const realL up = clamp(scene->box_edge[i][1] * way[0] - fabs(way[2]), (realL)0, (realL)1);
    const realL s = across * up;
    const realL share = s * s * ((real)3 - 2 * s) * (scene->box_level[i][0] + scene->box_level[i][1] * way[2]);
    EACH_CHANNEL (k, channels)
      radiance->channel[k] = fma(share, splat(scene->box_radiance[i][channels.first + k]), radiance->channel[k]);
  }
}

// The sky as a stone sees it: with the observer's head before it.
static inline void hide_by_head(world_t world, vec3L direction, maskL mask, channels_t channels, radianceL *radiance) {
  __constant const parameters_t *scene = world.scene;
  const vec3L apart = vec3(direction.x - scene->head[0], direction.y - scene->head[1], direction.z - scene->head[2]);
  const realL s = clamp(scene->head_rim - scene->head_slope * dot3(apart, apart), (realL)0, (realL)1);
  const realL share = blend(mask, s * s * ((real)3 - 2 * s), splat(0));
  EACH_CHANNEL (k, channels)
    radiance->channel[k] =
        fma(share, scene->head_radiance[channels.first + k] - radiance->channel[k], radiance->channel[k]);
}

// Smoothstep over 1 - cosine, from the lamp's rim to where it has its full radiance; as half the squared distance between
// unit vectors, since small lamps would lose their digits in a cosine next to 1.
static inline void add_lamps(__constant const parameters_t *scene, vec3L direction, channels_t channels,
                             radianceL *radiance) {
  for (int i = 0; i < scene->lamps; i++) {
    const vec3L apart =
        vec3(direction.x - scene->lamp[i][0], direction.y - scene->lamp[i][1], direction.z - scene->lamp[i][2]);
    const realL s = clamp(scene->lamp_rim[i] - scene->lamp_slope[i] * dot3(apart, apart), (realL)0, (realL)1);
    const realL share = s * s * ((real)3 - 2 * s);
    EACH_CHANNEL (k, channels)
      radiance->channel[k] = fma(share, splat(scene->lamp_radiance[i][channels.first + k]), radiance->channel[k]);
  }
}

static inline radianceL sky(world_t world, vec3L direction, channels_t channels) {
  __constant const parameters_t *scene = world.scene;
  const int kind = DECIDED(SKY, scene->sky_kind);
  radianceL radiance = black();
  if (kind == IMAGE) radiance = panorama(world, direction, channels);
  if (kind != IMAGE) {
    EACH_CHANNEL (k, channels) {
      const real bottom = scene->sky_bottom[channels.first + k], top = scene->sky_top[channels.first + k];
      if (kind == GRADIENT)
        radiance.channel[k] = bottom + (top - bottom) * ((real)0.5 * (direction.y + 1));
      else if (kind == HALF)
        radiance.channel[k] = blend(direction.y > 0, splat(top), splat(bottom));
      else
        radiance.channel[k] = splat(top);
    }
  }
  if (LAMPS != 0) add_lamps(scene, direction, channels, &radiance);
  if (BOXES != 0) add_boxes(scene, direction, channels, &radiance);
  return radiance;
}

#endif
