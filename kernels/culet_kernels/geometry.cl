// The stone, whatever its geometry: where light enters it, where light inside meets its surface, and what it shades.
#ifndef CULET_GEOMETRY
#define CULET_GEOMETRY
#include "features.cl"
#include "world.cl"

// Whether a ray can meet the stone at all: whether it passes the unit sphere around it, not wholly before t_min.
static inline maskL passes_stone(vec3L origin, vec3L direction, realL t_min) {
  const realL middle = -dot3(origin, direction);
  const vec3L nearest = along(origin, middle, direction);
  return (dot3(nearest, nearest) < (real)1.0001) & (middle > t_min - (real)1.0001);
}

static inline crossingL stone_entry(world_t world, vec3L origin, vec3L direction, realL t_min, maskL mask) {
  if (GEOMETRY == HULL) return hull_entry(world.facets, world.scene->facets, origin, direction, t_min);
  return mesh_crossing(world.scene, tree_of(world), origin, direction, t_min, (real)1e30, mask, 1);
}

static inline crossingL stone_exit(world_t world, vec3L origin, vec3L direction, maskL mask) {
  if (GEOMETRY == HULL) return hull_exit(world.facets, world.scene->facets, origin, direction);
  return mesh_crossing(world.scene, tree_of(world), origin, direction, splat(0), (real)1e30, mask, -1);
}

// Whether the stone lies between points of the room and a light.
static inline maskL stone_shadow(world_t world, int light, vec3L point, vec3L to_light, maskL mask) {
  if (GEOMETRY == EMPTY) return mask & !mask;
  // The line to the light passes the unit sphere if its moment about the centre is less than its length.
  const vec3L moment = cross3(point, to_light);
  const maskL near = mask & (dot3(moment, moment) < (real)1.0001 * dot3(to_light, to_light));
  if (!any_lane(near)) return near;
  if (GEOMETRY == HULL)
    return near &
           hull_shadow(world.shadows, world.scene->shadow_start[light], world.scene->shadow_start[light + 1], point);
  return mesh_crossing(world.scene, tree_of(world), point, to_light, splat(0), 1, near, 1).hit;
}

#endif
