// The room around the stone: floor, walls, lights and sky. A matte surface shows its albedo times the light that falls on
// it; a mirror returns four fifths, and shows a little light of its own.
#ifndef CULET_ROOM
#define CULET_ROOM
#include "batch.cl"
#include "light_map.cl"
#include "polarisation.cl"
#include "stones.cl"
#include "witness.cl"

#define MIRROR_REFLECTANCE ((real)0.8)
// The report's light: so much from all around, and so much of each light in its shadow.
#define CLASSIC_AMBIENT ((real)0.2)
#define CLASSIC_SHADOW ((real)0.2)
// Cosine to a surface below which a ray passes it by: the horizon, 1e6 R away for an eye 1 R above the floor. A ray that
// is closer to parallel would meet it where the checker is finer than a float.
#define HORIZON ((real)1e-6)
// R by which a point may lie behind a surface and still see it: a stone that rests on the floor, rounded.
#define SLOP ((real)1e-3)

// Who looks: a ray that has left a stone, or one of the camera's, by way of mirrors too.
#define BY_STONE 0
#define BY_CAMERA 1

typedef struct {
#if RECORDED
  intL surface;        // of the room
#endif
  maskL meets;         // floor or walls, not the sky
  maskL reflects;      // a mirror: the ray goes on
  maskL glossy;        // a studio floor, in which the camera sees the stone
  vec3L point, normal; // from where, if it does
  radianceL radiance;  // what is seen there: the surface's own light, or the sky
} viewL;

static inline realL checker(realL u, realL v) { // 0 or 0.5
  const realL half_sum = (real)0.5 * (floor_lanes(u) + floor_lanes(v));
  return half_sum - floor_lanes(half_sum);
}

// Where a ray meets the room.
typedef struct {
  vec3L point, normal;
  intL surface;
  realL along, across; // the surface's own coordinates, about the middle of its map
  maskL mask, matte;
} placeL;

// The light that falls on a surface, as the radiance of a white matte one: the sky's as if there were no stones, points'
// with their hard shadows, and what a light map adds. A map holds the points' shadows too: where there is one, none is
// looked for.
static inline radianceL lighting(world_t world, placeL place, radianceL from_sky, channels_t channels) {
  __constant const parameters_t *scene = world.scene;
  radianceL sum = from_sky;
  realL mapped = splat(0);
  if (DECIDED(LIGHT_MAP, scene->has_map))
    mapped = add_light_map(world, place.surface, place.along, place.across, place.matte, channels, &sum);
  if (LIGHTS != 0)
    for (int i = 0; i < scene->lights; i++) {
      const vec3L to_light = vec3(scene->light[i][0] - place.point.x, scene->light[i][1] - place.point.y,
                                  scene->light[i][2] - place.point.z);
      const realL cosine = dot3(place.normal, to_light) * rsqrt(fmax(dot3(to_light, to_light), splat((real)1e-30)));
      const maskL lit = place.mask & (cosine > 0);
      const maskL shaded = stone_shadow(world, i, place.point, to_light, lit & (mapped < 1));
      const realL passed = ESTIMATOR == CLASSIC ? splat(CLASSIC_SHADOW) : mapped;
      const realL arriving = blend(lit, cosine * blend(shaded, passed, splat(1)), splat(0));
      EACH_CHANNEL (k, channels)
        sum.channel[k] = fma(arriving, splat(scene->light_colour[i][channels.first + k]), sum.channel[k]);
    }
  if (LIGHT_MAP != 0)
    EACH_CHANNEL (k, channels) sum.channel[k] = fmax(sum.channel[k], splat(0)); // a map is rounded
  return sum;
}

// Rays outside the stone. What lies before `start` on them is not seen.
typedef struct {
  vec3L origin, direction;
  realL start;
  realL weight;
  polarisationL polarisation;
#if RECORDED
  intL event; // number of the event that it comes from
#endif
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

// What the camera sees in place of the sky, and of a studio floor, at a packet of pixels.
static inline radianceL backdrop_at(__constant const parameters_t *scene, const spotsL *spots, channels_t channels) {
  const realL x = ints_to_real(spots->column) + from_double(spots->right),
              y = ints_to_real(spots->row) + from_double(spots->down);
  const realL across = scene->backdrop_scale[0] * (x - scene->backdrop_focus[0]),
              down = scene->backdrop_scale[1] * (y - scene->backdrop_focus[1]);
  const realL part = fmin(sqrt(across * across + down * down), splat(1)), share = part * part * ((real)3 - 2 * part);
  radianceL radiance = black();
  EACH_CHANNEL (k, channels) {
    const real centre = scene->backdrop_centre[channels.first + k], edge = scene->backdrop_edge[channels.first + k];
    radiance.channel[k] = fma(share, splat(edge - centre), splat(centre));
  }
  return radiance;
}

// The part of an even sky's light that a convex body keeps from a point of the floor is, from afar, the solid angle that
// it fills there, times its cosine, over pi. Here the body is the ellipsoid x' S^-1 x = 1 that is spread as the stone is,
// seen from p below its centre: its outline has the area pi sqrt(det S p' S^-1 p) / |p|, so that the part is
// height sqrt(det S p' S^-1 p) / |p|^4; `contact` is det S S^-1. For a ball it is exact, down to where they touch. Near a
// flat body it is more than all, so it is led towards 1.
#define MOST_SHADE ((real)100)
static inline realL contact_shadow(__constant const stone_t *stone, vec3L point) {
  realL outline = splat(0);
  EACH (k, 3) {
    const realL row = fma(point.x, splat(stone->contact[k][0]),
                          fma(point.y, splat(stone->contact[k][1]), point.z * stone->contact[k][2]));
    outline = fma(row, k == 0 ? point.x : k == 1 ? point.y : point.z, outline);
  }
  const realL squared = fmax(dot3(point, point), splat((real)1e-6)), height = fmax(-point.y, splat(0));
  const realL part = fmin(height * sqrt(fmax(outline, splat(0))) / (squared * squared), splat(MOST_SHADE));
  return stone->contact_shadow * part * rsqrt(sqrt(1 + part * part * part * part));
}

// The part of an even sky's light that reaches a point of the floor past all stones.
static inline realL past_stones(world_t world, vec3L point) {
  if (GEOMETRY == EMPTY) return splat(1);
  if (STONES == ONE) return 1 - contact_shadow(world.stones, point);
  realL part = splat(1);
  for (int i = 0; i < world.scene->groups; i++) {
    __constant const group_t *group = world.groups + i;
    const vec3L apart = vec3(point.x - group->centre[0], point.y - group->centre[1], point.z - group->centre[2]);
    if (!any_lane(dot3(apart, apart) < group->shade_reach * group->shade_reach)) continue;
    for (int number = group->first; number < group->last; number++) {
      __constant const stone_t *stone = world.stones + number;
      const vec3L own = to_own(world, number, point);
      const real reach = stone->shade_reach * stone->inverse_radius;
      if (!any_lane(dot3(own, own) < reach * reach)) continue;
      const realL shade = contact_shadow(stone, own);
      part *= 1 - fmax(shade - world.scene->least_shade, splat(0));
    }
  }
  return part;
}

// What a ray that meets no stone shows, of the lanes that are `wanted`. What the camera sees in place of the sky is `backdrop`, if
// that is not null.
static inline viewL look(world_t world, rayL ray, maskL wanted, int viewer, const radianceL *backdrop,
                         channels_t channels) {
  __constant const parameters_t *scene = world.scene;
  const int floor_kind = DECIDED(FLOOR, scene->floor_kind), walls_kind = DECIDED(WALLS, scene->walls_kind);
  viewL view;
  const maskL none = ray.start < ray.start;
  view.meets = view.reflects = view.glossy = none;
  view.point = ray.origin;
  view.normal = ray.direction;
  view.radiance = black();
#if RECORDED
  view.surface = 0;
#endif
  const int has_map = DECIDED(LIGHT_MAP, scene->has_map);
  const int endless = walls_kind == NONE ? floor_kind == STUDIO_FLOOR : 0;
  const int same = has_map ? 0 : endless;
  const int plain = viewer == BY_STONE ? same : 0; // a floor that is the same wherever it is met
  const int first = floor_kind == NONE ? 1 : plain, last = walls_kind == NONE ? 1 : MAX_SURFACES;
  // What is met is the floor then, and nothing has to be chosen by lane. What is recorded tells of the sky, too.
  const int floor_alone = RECORDED ? 0 : walls_kind == NONE;

  realL nearest = splat(1e30f), centre_along = splat(0), centre_across = splat(0);
  maskL met = plain ? ray.direction.y < -HORIZON : none, mirror = none, studio = none;
  radianceL from_sky = black();
  placeL place;
  place.surface = (intL)(first);
  for (int i = first; i < last; i++) {
    const real nx = scene->surface[i][0], ny = scene->surface[i][1], nz = scene->surface[i][2];
    const realL speed = ray.direction.x * nx + ray.direction.y * ny + ray.direction.z * nz;
    const realL gap = ray.origin.x * nx + ray.origin.y * ny + ray.origin.z * nz - scene->surface[i][3];
    const realL t = fmax(gap / fmax(-speed, splat(HORIZON)), ray.start);
    const maskL nearer = (speed < -HORIZON) & (gap + ray.start * speed > -SLOP) & (t < nearest);
    nearest = blend(nearer, t, nearest);
    const maskL taken = floor_alone ? !none : nearer;
    view.normal = blend3(taken, vec3(splat(nx), splat(ny), splat(nz)), view.normal);
    EACH_CHANNEL (k, channels)
      from_sky.channel[k] = blend(taken, splat(scene->sky_light[i][channels.first + k]), from_sky.channel[k]);
    if (has_map) {
      place.surface = blend_ints_by(taken, (intL)(i), place.surface);
      centre_along = blend(taken, splat(scene->map_centre[i][0]), centre_along);
      centre_across = blend(taken, splat(scene->map_centre[i][1]), centre_across);
    }
    met |= nearer;
#if RECORDED
    view.surface = nearer ? i : view.surface;
#endif
    const int kind = i == 0 ? floor_kind : walls_kind;
    mirror = kind == MIRROR ? mirror | nearer : mirror & !nearer;
    if (floor_kind == STUDIO_FLOOR) studio = i == 0 ? nearer : studio & !nearer;
  }
  if (backdrop) // unconditionally: a floor that nothing shades shows it too, and then need not be looked for
    view.radiance = *backdrop;
  else if (any_lane(wanted & !met)) {
    view.radiance = sky(world, ray.direction, channels);
    if (viewer == BY_STONE && DECIDED(HEAD, scene->has_head))
      hide_by_head(world, ray.direction, !none, channels, &view.radiance);
  }
  if (plain) {
    view.meets = met;
    EACH_CHANNEL (k, channels)
      view.radiance.channel[k] = blend(met, splat(scene->floor_colour[channels.first + k]), view.radiance.channel[k]);
    return view;
  }
  if (!any_lane(met)) return view;
  nearest = blend(met, nearest, splat(0));
  view.point = along(ray.origin, nearest, ray.direction);
  view.meets = met;
  const maskL is_floor = floor_alone ? !none : view.normal.y > (real)0.5;
  if (has_map) {
    place.along =
        blend(is_floor, view.point.x, view.normal.z * view.point.x - view.normal.x * view.point.z) - centre_along;
    place.across = blend(is_floor, view.point.z, view.point.y) - centre_across;
  }
  if (floor_kind == STUDIO_FLOOR) {
    const realL open = viewer == BY_CAMERA ? past_stones(world, view.point) : splat(1);
    radianceL thrown = black();
    if (has_map ? scene->floor_mapped : 0)
      add_light_map(world, place.surface, place.along, place.across, studio, channels, &thrown);
    EACH_CHANNEL (k, channels) {
      const realL colour = backdrop ? backdrop->channel[k] : splat(scene->floor_colour[channels.first + k]);
      realL lit = open;
      if (has_map) {
        const real even = scene->even_light[channels.first + k];
        lit = fmax(fma(even, open, (1 - even) + scene->map_gain[channels.first + k] * thrown.channel[k]), splat(0));
      }
      view.radiance.channel[k] = blend(studio, lit * colour, view.radiance.channel[k]);
    }
    view.glossy = studio;
    if (walls_kind == NONE) return view;
    met &= !studio;
  }

  // Checkers are counted in the world: over x and z on the floor, along the wall and over y on a wall.
  const realL x = view.point.x + scene->origin[0], y = view.point.y + scene->origin[1],
              z = view.point.z + scene->origin[2];
  const realL cells = blend(is_floor, splat(scene->cells[0]), splat(scene->cells[1]));
  const realL u = blend(is_floor, x, view.normal.z * x - view.normal.x * z), v = blend(is_floor, z, y);
  const maskL odd = checker(cells * u, cells * v) > (real)0.25;
  place.point = view.point;
  place.normal = view.normal;
  place.mask = met;
  place.matte = met & !mirror;
  if (ESTIMATOR == CLASSIC)
    EACH_CHANNEL (k, channels) from_sky.channel[k] = splat(CLASSIC_AMBIENT);
  const radianceL light = lighting(world, place, from_sky, channels);
  EACH_CHANNEL (k, channels) {
    const int channel = channels.first + k;
    const realL floor_albedo = blend(odd, splat(scene->albedo[0][0][channel]), splat(scene->albedo[0][1][channel]));
    const realL wall_albedo = blend(odd, splat(scene->albedo[1][0][channel]), splat(scene->albedo[1][1][channel]));
    const realL albedo = walls_kind == NONE ? floor_albedo : blend(is_floor, floor_albedo, wall_albedo);
    view.radiance.channel[k] = blend(met, albedo * light.channel[k], view.radiance.channel[k]);
  }
  view.reflects = met & mirror;
  return view;
}

#if RECORDED
// What a ray outside sees, as if its weight came to 1 at its beginning.
static inline int tell_view(world_t world, rayL ray, viewL view, channels_t channels) {
  happening_t event = event_of(view.meets ? LANDS : SEES, ray.event);
  set_place(&event, ray.origin, ray.direction, view.normal);
  event.surface = view.meets ? view.surface : -1;
  event.weight[0] = event.weight[1] = ray.weight;
  event.kept = view.reflects ? MIRROR_REFLECTANCE : 0;
  for (int k = 0; k < channels.count; k++) event.light[k] = ray.weight * view.radiance.channel[k];
  return append_event(world, event);
}

static inline void tell_loss(world_t world, rayL ray) {
  happening_t event = event_of(ENDS, ray.event);
  set_place(&event, ray.origin, ray.direction, ray.direction);
  event.weight[0] = event.weight[1] = event.cut = ray.weight;
  append_event(world, event);
}
#endif

// Light in a mirror is followed down to this part of the cut-off, so that what leaves a chain that goes on is seen in
// full, by way of a few mirrors at least.
#define MIRROR_CUTOFF ((real)0.1)

// Follows rays through the room by way of its mirrors. Returns the radiance that they gather. `towards` takes the lanes to
// follow, and gives back those that a mirror has sent towards a stone, in `ray` as they leave the mirror. A ray's whole
// weight is `share` times its own; if that is below the cut-off, the stone is left out of its way. What that may have
// hidden, and the rays that mirrors would pass on for ever, are added to `cut`. For the camera `glossy` takes up the lanes
// that end at a studio floor, in `ray` as they meet it.
__attribute__((always_inline)) static inline radianceL gather(world_t world, rayL *ray, realL share, int viewer,
                                                              const radianceL *backdrop, maskL *towards, maskL *glossy,
                                                              realL *cut, channels_t channels) {
  const real cutoff = world.scene->cutoff;
  radianceL radiance = black();
  maskL active = *towards;
  *towards = active & !active;
  for (;;) {
    const viewL view = look(world, *ray, active, viewer, backdrop, channels);
    EACH_CHANNEL (k, channels) radiance.channel[k] += blend(active, ray->weight * view.radiance.channel[k], splat(0));
#if RECORDED
    if (active) ray->event = tell_view(world, *ray, view, channels);
#endif
    const int studio = DECIDED(FLOOR, world.scene->floor_kind) == STUDIO_FLOOR;
    if (studio ? viewer == BY_CAMERA : 0) {
      const maskL ends = active & view.glossy;
      *glossy |= ends;
      ray->origin = blend3(ends, view.point, ray->origin);
    }
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
      const maskL heading = active & passes_stones(world, ray->origin, ray->direction, splat(0));
      const maskL matters = whole >= cutoff;
      *towards |= heading & matters;
      *cut += blend(heading & !matters, ray->weight, splat(0));
#if RECORDED
      if (heading & !matters) tell_loss(world, *ray);
#endif
      active &= !(heading & matters);
    }
    const maskL faint = active & (whole < MIRROR_CUTOFF * cutoff);
    *cut += blend(faint, ray->weight, splat(0));
#if RECORDED
    if (faint) tell_loss(world, *ray);
#endif
    active &= !faint;
  }
}

#endif
