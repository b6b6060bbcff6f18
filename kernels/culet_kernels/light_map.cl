// What shadows and caustics add to the light of floor and walls: maps on the device, of which each surface has two levels,
// a fine one about the stones and a coarse one about that. Texels hold the radiance of a white matte surface.
#ifndef CULET_LIGHT_MAP
#define CULET_LIGHT_MAP
#include "sky.cl"

// Part of a level's half size over which it gives way to the next one, or to none.
#define MAP_RIM ((real)0.0625)

// Between the four nearest texels of a level; a place is -1 to 1 over it. Adds `share` of it to `sum`.
static inline void add_level(world_t world, intL surface, int level, realL column_place, realL row_place, realL share,
                             channels_t channels, radianceL *sum) {
  const realL last = splat(MAP_SIZE - 1);
  const realL u = clamp(fma(column_place, splat(MAP_SIZE / 2), (real)0.5 * last), splat(0), last),
              v = clamp(fma(row_place, splat(MAP_SIZE / 2), (real)0.5 * last), splat(0), last);
  const intL left = clamp(reals_to_int(u), (intL)(0), (intL)(MAP_SIZE - 2)),
             upper = clamp(reals_to_int(v), (intL)(0), (intL)(MAP_SIZE - 2));
  const realL right_share = u - ints_to_real(left), lower_share = v - ints_to_real(upper);
  const intL place = 3 * (((surface * MAP_LEVELS + level) * MAP_SIZE + upper) * MAP_SIZE + left) + channels.first;
  EACH (corner, 4) {
    const int right = corner & 1, lower = corner >> 1;
    const realL weight =
        share * (right ? right_share : (real)1 - right_share) * (lower ? lower_share : (real)1 - lower_share);
    __global const float *texels = world.light_map + 3 * (lower * MAP_SIZE + right);
    EACH_CHANNEL (k, channels) sum->channel[k] = fma(weight, gather_floats(texels + k, place), sum->channel[k]);
  }
}

// Adds what the map of a surface holds at (u, v) of the frame to `sum`; returns the share of the map there, which falls to
// 0 at its rim.
static inline realL add_light_map(world_t world, intL surface, realL u, realL v, maskL mask, channels_t channels,
                                  radianceL *sum) {
  __constant const parameters_t *scene = world.scene;
  realL whole = splat(0);
  surface = blend_ints_by(mask, surface, (intL)(scene->mapped_surface)); // elsewhere there may be no map to read
  EACH (level, MAP_LEVELS) {
    const realL column_place = u * scene->map_scale[level], row_place = v * scene->map_scale[level];
    const realL from_middle = fmax(fabs(column_place), fabs(row_place));
    const realL within = clamp(((real)1 - from_middle) * (1 / MAP_RIM), (realL)0, (realL)1);
    const realL share = blend(mask, within * ((real)1 - whole), splat(0));
    whole += share;
    if (any_lane(share > 0)) add_level(world, surface, level, column_place, row_place, share, channels, sum);
  }
  return whole;
}

#endif
