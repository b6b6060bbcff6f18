// The stone, whatever its geometry: where light enters it, where light inside meets its surface, and what it shades.
#ifndef CULET_GEOMETRY
#define CULET_GEOMETRY
#include "features.cl"
#include "hull.cl"
#include "mesh.cl"

// What a scene is made of; the quantities are constants, the rest is read in long runs.
typedef struct {
  __constant const parameters_t *scene;
  __global const real4 *facets;  // HULL: normal and offset, the world's axes
  __global const real4 *shadows; // HULL: planes of the lights' shadow volumes
  __global const real *tree;     // MESH: boxes of the tree's nodes
  __global const int *links;     // MESH: what they lead to
  __global const real *corners;  // MESH: triangles, a packet to a leaf
} world_t;

// Whether a ray can meet the stone at all: whether it passes the unit sphere around it, ahead of t_min.
static inline maskL passes_stone(vec3L origin, vec3L direction, realL t_min) {
  const realL middle = -dot3(origin, direction);
  const vec3L nearest = along(origin, middle, direction);
  return (dot3(nearest, nearest) < (real)1.0001) & (middle > t_min - (real)1.0001);
}

static inline crossingL stone_entry(world_t world, vec3L origin, vec3L direction, realL t_min, maskL mask) {
  if (GEOMETRY == HULL) return hull_entry(world.facets, world.scene->facets, origin, direction, t_min);
  if (GEOMETRY == MESH)
    return mesh_crossing(world.scene, world.tree, world.links, world.corners, origin, direction, t_min, mask, true);
  const crossingL none = {t_min < t_min, t_min, direction};
  return none;
}

static inline crossingL stone_exit(world_t world, vec3L origin, vec3L direction, maskL mask) {
  if (GEOMETRY == MESH)
    return mesh_crossing(world.scene, world.tree, world.links, world.corners, origin, direction, splat(0), mask, false);
  return hull_exit(world.facets, world.scene->facets, origin, direction);
}

// Whether the stone lies between points of the room and a light.
static inline maskL stone_shadow(world_t world, int light, vec3L point, vec3L to_light, maskL mask) {
  if (GEOMETRY == EMPTY) return mask & !mask;
  const vec3L lever = vec3(fma(point.y, to_light.z, -point.z * to_light.y), fma(point.z, to_light.x, -point.x * to_light.z),
                           fma(point.x, to_light.y, -point.y * to_light.x));
  const maskL near = mask & (dot3(lever, lever) < (real)1.0001 * dot3(to_light, to_light));
  if (!any_lane(near)) return near;
  if (GEOMETRY == HULL)
    return near & hull_shadow(world.shadows, world.scene->shadow_start[light], world.scene->shadow_start[light + 1], point);
  return near & mesh_shadow(world.scene, world.tree, world.links, world.corners, point, to_light, near);
}

#endif
