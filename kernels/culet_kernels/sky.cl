// Radiance from infinity, and radiance by channel.
#ifndef CULET_SKY
#define CULET_SKY
#include "features.cl"
#include "parameters.cl"
#include "vector.cl"

// Radiance in up to three channels. Which ones, `channels_t` says: all three, or the one of a dispersed chain; its count
// is known at compile time wherever it is used, so that the channels left out cost nothing.
typedef struct {
  realL channel[3];
} radianceL;

typedef struct {
  int first, count;
} channels_t;

static inline channels_t all_channels(void) {
  const channels_t channels = {0, 3};
  return channels;
}

static inline radianceL black(void) {
  const radianceL none = {{splat(0), splat(0), splat(0)}};
  return none;
}

static inline radianceL sky(__constant const parameters_t *scene, vec3L direction, channels_t channels) {
  const int kind = DECIDED(SKY, scene->sky_kind);
  radianceL radiance = black();
  if (kind == STUDIO) {
    for (int k = 0; k < channels.count; k++) radiance.channel[k] = splat(scene->sky_bottom[channels.first + k]);
    for (int i = 0; i < scene->lamps; i++) {
      // Smoothstep from the lamp's rim to where it has its full radiance.
      const realL cosine = direction.x * scene->lamp[i][0] + direction.y * scene->lamp[i][1] + direction.z * scene->lamp[i][2];
      const realL s = clamp(cosine - scene->lamp_edge[i], (realL)0, (realL)1);
      const realL share = s * s * ((real)3 - 2 * s);
      for (int k = 0; k < channels.count; k++)
        radiance.channel[k] = fma(share, splat(scene->lamp_radiance[i][channels.first + k]), radiance.channel[k]);
    }
    return radiance;
  }
  for (int k = 0; k < channels.count; k++) {
    const real bottom = scene->sky_bottom[channels.first + k], top = scene->sky_top[channels.first + k];
    if (kind == GRADIENT)
      radiance.channel[k] = bottom + (top - bottom) * ((real)0.5 * (direction.y + 1));
    else if (kind == HALF)
      radiance.channel[k] = blend(direction.y > 0, splat(top), splat(bottom));
    else
      radiance.channel[k] = splat(top);
  }
  return radiance;
}

#endif
