// Vectors of three lanes.
#ifndef CULET_VECTOR
#define CULET_VECTOR
#include "lanes.cl"

typedef struct {
  realL x, y, z;
} vec3L;

static inline vec3L vec3(realL x, realL y, realL z) {
  vec3L v = {x, y, z};
  return v;
}

// To three rows of numbers, and back.
static inline void store3(vec3L v, real rows[3][LANES]) {
  store_lanes(v.x, rows[0]);
  store_lanes(v.y, rows[1]);
  store_lanes(v.z, rows[2]);
}
static inline vec3L load3(real rows[3][LANES]) {
  return vec3(load_lanes(rows[0]), load_lanes(rows[1]), load_lanes(rows[2]));
}

static inline realL dot3(vec3L a, vec3L b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

// With a vector that is the same in every lane.
static inline realL dot_uniform(vec3L a, real4 b) { return fma(a.x, splat(b.x), fma(a.y, splat(b.y), a.z * b.z)); }

static inline vec3L along(vec3L origin, realL t, vec3L direction) {
  return vec3(fma(t, direction.x, origin.x), fma(t, direction.y, origin.y), fma(t, direction.z, origin.z));
}

static inline vec3L cross3(vec3L a, vec3L b) {
  return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline vec3L scale3(realL s, vec3L a) { return vec3(s * a.x, s * a.y, s * a.z); }

static inline vec3L blend3(maskL mask, vec3L yes, vec3L no) {
  return vec3(blend(mask, yes.x, no.x), blend(mask, yes.y, no.y), blend(mask, yes.z, no.z));
}

static inline vec3L normalise(vec3L a) { return scale3(rsqrt(dot3(a, a)), a); }

// One Newton step toward unit length: enough for a vector that rounding has moved from it.
static inline vec3L renormalise(vec3L a) { return scale3(fma((real)-0.5, dot3(a, a), (realL)((real)1.5)), a); }

// a is mirrored at the plane with normal n; a_dot_n is their dot product.
static inline vec3L reflect3(vec3L a, realL a_dot_n, vec3L n) { return along(a, (real)-2 * a_dot_n, n); }

// To axes whose columns these are, and back.
static inline vec3L into_axes(__constant const real axes[3][3], vec3L v) {
  return vec3(v.x * axes[0][0] + v.y * axes[1][0] + v.z * axes[2][0],
              v.x * axes[0][1] + v.y * axes[1][1] + v.z * axes[2][1],
              v.x * axes[0][2] + v.y * axes[1][2] + v.z * axes[2][2]);
}
static inline vec3L out_of_axes(__constant const real axes[3][3], vec3L v) {
  return vec3(v.x * axes[0][0] + v.y * axes[0][1] + v.z * axes[0][2],
              v.x * axes[1][0] + v.y * axes[1][1] + v.z * axes[1][2],
              v.x * axes[2][0] + v.y * axes[2][1] + v.z * axes[2][2]);
}

#endif
