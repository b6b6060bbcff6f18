// The room around the stone: floor, walls, lights and sky. Its look is the report's: a checker of cells of 1 R, a matte
// surface of radiance albedo (0.2 + sum of colour max(n.l, 0) shadow), and a mirror that returns four fifths.
#ifndef CULET_ROOM
#define CULET_ROOM
#include "geometry.cl"
#include "polarisation.cl"
#include "sky.cl"

#define AMBIENT ((real)0.2)      // of a matte surface, in lights of colour 1
#define SHADOW ((real)0.2)       // what reaches a shaded point of a light
#define MIRROR_REFLECTANCE ((real)0.8)
#define MIRROR_SHARE ((real)0.2) // of a mirror's own light in what it shows
// Cosine to a surface below which a ray passes it by: the horizon, 1e6 R away for an eye 1 R above the floor. A ray that
// is closer to parallel would meet it where the checker is finer than a float.
#define HORIZON ((real)1e-6)
// R by which a point may lie behind a surface and still see it: a stone that rests on the floor, rounded.
#define SLOP ((real)1e-3)

typedef struct {
  maskL meets;         // floor or walls, not the sky
  maskL reflects;      // a mirror: the ray goes on
  vec3L point, normal; // from where, if it does
  radianceL radiance;  // what is seen there: the surface's own light, or the sky
} viewL;

static inline realL checker(realL u, realL v) { // 0 or 0.5
  const realL half_sum = (real)0.5 * (floor_lanes(u) + floor_lanes(v));
  return half_sum - floor_lanes(half_sum);
}

// The light that falls on a surface, ambient included.
static inline radianceL lighting(world_t world, vec3L point, vec3L normal, maskL mask, channels_t channels) {
  __constant const parameters_t *scene = world.scene;
  radianceL sum = {{splat(AMBIENT), splat(AMBIENT), splat(AMBIENT)}};
  if (LIGHTS == 0) return sum;
  for (int i = 0; i < scene->lights; i++) {
    const vec3L to_light =
        vec3(scene->light[i][0] - point.x, scene->light[i][1] - point.y, scene->light[i][2] - point.z);
    const realL cosine = dot3(normal, to_light) * rsqrt(fmax(dot3(to_light, to_light), splat((real)1e-30)));
    const maskL lit = mask & (cosine > 0);
    const maskL shaded = stone_shadow(world, i, point, to_light, lit);
    const realL arriving = blend(lit, cosine * blend(shaded, splat(SHADOW), splat(1)), splat(0));
    EACH_CHANNEL (k, channels)
      sum.channel[k] = fma(arriving, splat(scene->light_colour[i][channels.first + k]), sum.channel[k]);
  }
  return sum;
}

// Rays outside the stone. What lies before `start` on them is not seen.
typedef struct {
  vec3L origin, direction;
  realL start;
  realL weight;
  polarisationL polarisation;
} rayL;

// Whether floor or walls come before the stone; only where the stone reaches through one of them.
static inline maskL hidden_by_room(world_t world, rayL ray, realL t) {
  __constant const parameters_t *scene = world.scene;
  maskL hidden = t < t; // none
  if (!scene->pierces) return hidden;
  const int floor_kind = DECIDED(FLOOR, scene->floor_kind), walls_kind = DECIDED(WALLS, scene->walls_kind);
  for (int i = floor_kind == NONE ? 1 : 0; i < (walls_kind == NONE ? 1 : MAX_SURFACES); i++) {
    const real4 surface =
        (real4)(scene->surface[i][0], scene->surface[i][1], scene->surface[i][2], scene->surface[i][3]);
    const vec3L start = along(ray.origin, ray.start, ray.direction), end = along(ray.origin, t, ray.direction);
    hidden |= (dot_uniform(start, surface) > surface.w) & (dot_uniform(end, surface) < surface.w);
  }
  return hidden;
}

// What a ray that meets no stone shows.
static inline viewL look(world_t world, rayL ray, channels_t channels) {
  __constant const parameters_t *scene = world.scene;
  const int floor_kind = DECIDED(FLOOR, scene->floor_kind), walls_kind = DECIDED(WALLS, scene->walls_kind);
  viewL view;
  view.meets = view.reflects = ray.start < ray.start; // none
  view.point = ray.origin;
  view.normal = ray.direction;
  view.radiance = sky(world, ray.direction, channels);
  const int first = floor_kind == NONE ? 1 : 0, last = walls_kind == NONE ? 1 : MAX_SURFACES;
  if (first == last) return view;

  realL nearest = splat(1e30f);
  maskL met = view.meets, mirror = view.meets;
  for (int i = first; i < last; i++) {
    const real nx = scene->surface[i][0], ny = scene->surface[i][1], nz = scene->surface[i][2];
    const realL speed = ray.direction.x * nx + ray.direction.y * ny + ray.direction.z * nz;
    const realL gap = ray.origin.x * nx + ray.origin.y * ny + ray.origin.z * nz - scene->surface[i][3];
    const realL t = fmax(gap / fmax(-speed, splat(HORIZON)), ray.start);
    const maskL nearer = (speed < -HORIZON) & (gap + ray.start * speed > -SLOP) & (t < nearest);
    nearest = blend(nearer, t, nearest);
    view.normal = blend3(nearer, vec3(splat(nx), splat(ny), splat(nz)), view.normal);
    met |= nearer;
    const int kind = i == 0 ? floor_kind : walls_kind;
    mirror = kind == MIRROR ? mirror | nearer : mirror & !nearer;
  }
  if (!any_lane(met)) return view;
  nearest = blend(met, nearest, splat(0));
  view.point = along(ray.origin, nearest, ray.direction);

  // Checkers are counted in the world: over x and z on the floor, along the wall and over y on a wall.
  const realL x = view.point.x + scene->centre[0], y = view.point.y + scene->centre[1],
              z = view.point.z + scene->centre[2];
  const maskL is_floor = view.normal.y > (real)0.5;
  const realL u = blend(is_floor, x, view.normal.z * x - view.normal.x * z), v = blend(is_floor, z, y);
  const maskL odd = checker(u, v) > (real)0.25;
  const realL matte = blend(odd, splat((real)0.9), splat((real)0.6));
  const realL mirrored = MIRROR_SHARE * blend(odd, splat((real)0.05), splat((real)0.1));
  const realL albedo = blend(mirror, mirrored, matte);
  const radianceL light = lighting(world, view.point, view.normal, met, channels);
  EACH_CHANNEL (k, channels) view.radiance.channel[k] = blend(met, albedo * light.channel[k], view.radiance.channel[k]);
  view.meets = met;
  view.reflects = met & mirror;
  return view;
}

// Light in a mirror is followed down to this part of the cut-off, so that what leaves a chain that goes on is seen in
// full, by way of a few mirrors at least.
#define MIRROR_CUTOFF ((real)0.1)

// Follows rays through the room by way of its mirrors. Returns the radiance that they gather. `towards` takes the lanes to
// follow, and gives back those that a mirror has sent towards the stone, in `ray` as they leave the mirror. A ray's whole
// weight is `share` times its own; if that is below the cut-off, the stone is left out of its way. What that may have
// hidden, and the rays that mirrors would pass on for ever, are added to `cut`.
__attribute__((always_inline)) static inline radianceL gather(world_t world, rayL *ray, realL share, maskL *towards,
                                                              realL *cut, channels_t channels) {
  const real cutoff = world.scene->cutoff;
  radianceL radiance = black();
  maskL active = *towards;
  *towards = active & !active;
  for (;;) {
    const viewL view = look(world, *ray, channels);
    EACH_CHANNEL (k, channels) radiance.channel[k] += blend(active, ray->weight * view.radiance.channel[k], splat(0));
    active &= view.reflects;
    if (!any_lane(active)) return radiance;
    ray->start = blend(active, splat(0), ray->start);
    ray->weight = blend(active, MIRROR_REFLECTANCE * ray->weight, ray->weight);
    ray->origin = blend3(active, view.point, ray->origin);
    ray->direction =
        blend3(active, reflect3(ray->direction, dot3(ray->direction, view.normal), view.normal), ray->direction);
    if (POLARISED)
      ray->polarisation =
          blend_polarisation(active, mirror_polarisation(ray->polarisation, view.normal), ray->polarisation);
    const realL whole = share * ray->weight;
    if (REENTRY) {
      const maskL heading = active & passes_stone(ray->origin, ray->direction, splat(0));
      const maskL matters = whole >= cutoff;
      *towards |= heading & matters;
      *cut += blend(heading & !matters, ray->weight, splat(0));
      active &= !(heading & matters);
    }
    const maskL faint = active & (whole < MIRROR_CUTOFF * cutoff);
    *cut += blend(faint, ray->weight, splat(0));
    active &= !faint;
  }
}

#endif
