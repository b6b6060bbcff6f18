// Primary rays of a pinhole camera.
#ifndef CULET_CAMERA
#define CULET_CAMERA
#include "batch.cl"
#include "vector.cl"

typedef struct {
  vec3L origin;    // next to the stone, not at the eye: from far away a float could not place the ray on it
  vec3L direction; // of unit length
  realL eye;       // where on the ray the eye is: nothing before it is seen
} primaryL;

// A packet's rays.
static inline primaryL primary_rays(__constant const parameters_t *scene, const spotsL *spots) {
  const doubleL x = spots->x, y = spots->y;
  const vec3L foot = vec3(from_double(scene->foot[0] + x * scene->foot_column[0] + y * scene->foot_row[0]),
                          from_double(scene->foot[1] + x * scene->foot_column[1] + y * scene->foot_row[1]),
                          from_double(scene->foot[2] + x * scene->foot_column[2] + y * scene->foot_row[2]));
  const realL u = from_double(x), v = from_double(y);
  const vec3L direction = vec3(scene->direction[0] + u * scene->direction_column[0] + v * scene->direction_row[0],
                               scene->direction[1] + u * scene->direction_column[1] + v * scene->direction_row[1],
                               scene->direction[2] + u * scene->direction_column[2] + v * scene->direction_row[2]);
  const realL squared = dot3(direction, direction), inverse = rsqrt(squared);
  const primaryL ray = {foot, scale3(inverse, direction), -scene->reach * squared * inverse};
  return ray;
}

#endif
