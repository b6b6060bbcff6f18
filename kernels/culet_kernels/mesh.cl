#ifndef CULET_MESH
#define CULET_MESH
#include "hull.cl"

static inline crossingL mesh_crossing(__constant const parameters_t *scene, __global const real *tree,
                                      __global const int *links, __global const real *corners, vec3L origin,
                                      vec3L direction, realL t_min, maskL mask, bool from_outside) {
  const crossingL none = {t_min < t_min, t_min, direction};
  return none;
}

static inline maskL mesh_shadow(__constant const parameters_t *scene, __global const real *tree,
                                __global const int *links, __global const real *corners, vec3L point, vec3L to_light,
                                maskL mask) {
  return mask & !mask;
}
#endif
