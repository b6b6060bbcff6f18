// A convex stone is the intersection of its facets' half-spaces n.x <= w: no triangle edges, no epsilon, no crack
// (Haines, Fast Ray-Convex Polyhedron Intersection, Graphics Gems II, 1991).
#ifndef CULET_HULL
#define CULET_HULL
#include "parameters.cl"
#include "vector.cl"

typedef struct {
  maskL hit;
  realL t;
  vec3L normal; // outward
} crossingL;

// Where a facet is parallel to the ray, its plane is crossed this many R away: far, yet finite, since the kernels are
// built on the promise that nothing is infinite.
#define PARALLEL ((real)1e-18)

// The part of a line that is inside, and the facet by which it comes in.
typedef struct {
  realL t_in, t_out; // nothing is inside where t_in >= t_out
  vec3L normal;      // outward
} spanL;

// Where a ray from outside enters and leaves. A facet that is parallel to the ray and has it outside counts as entered at infinity,
// so that the ray misses.
static inline spanL hull_span(__global const real4 *facets, int count, vec3L origin, vec3L direction) {
  realL t_in = splat(-1e30f), t_out = splat(1e30f);
  vec3L normal = vec3(splat(0), splat(0), splat(0));
  for (int i = 0; i < count; i++) {
    const real4 facet = facets[i];
    const realL speed = dot_uniform(direction, facet);
    const realL gap = facet.w - dot_uniform(origin, facet);
    const maskL entering = speed <= 0;
    const realL t = gap / blend(entering, fmin(speed, -PARALLEL), fmax(speed, PARALLEL));
    const maskL later = entering & (t > t_in);
    t_in = blend(later, t, t_in);
    normal = blend3(later, vec3(splat(facet.x), splat(facet.y), splat(facet.z)), normal);
    t_out = blend(entering, t_out, fmin(t_out, t));
  }
  const spanL span = {t_in, t_out, normal};
  return span;
}

static inline crossingL hull_entry(__global const real4 *facets, int count, vec3L origin, vec3L direction,
                                   realL t_min) {
  const spanL span = hull_span(facets, count, origin, direction);
  const crossingL crossing = {(span.t_in < span.t_out) & (span.t_in >= t_min), span.t_in, span.normal};
  return crossing;
}

// The same; and a ray that starts inside, by more than `least` along it, enters where it starts, through the facet by which it
// would have come in.
static inline crossingL hull_entry_from(__global const real4 *facets, int count, vec3L origin, vec3L direction,
                                        realL t_min, real least) {
  const spanL span = hull_span(facets, count, origin, direction);
  const realL t = fmax(span.t_in, t_min);
  const crossingL crossing = {
      (span.t_in < span.t_out) & (span.t_out - t > blend(span.t_in < t_min, splat(least), splat(0))), t, span.normal};
  return crossing;
}

// A gap below this counts as this, R: the facet that the ray has just left has a gap of rounding size, and a speed of
// rounding size if the ray grazes it; their quotient must not win over the facet that lies ahead.
#if IS_DOUBLE
#define SMALLEST_GAP 1e-16
#else
#define SMALLEST_GAP 1e-7f
#endif

// The facet that a ray inside reaches first, of some: it nears it by `speed` per length and is `gap` away.
typedef struct {
  realL speed, gap;
  vec3L normal; // outward
} approachL;

// Which is reached first, by the larger speed / gap, without a division: gaps are positive. A facet that the ray moves away
// from has a negative speed, and is never reached.
static inline approachL sooner(approachL a, approachL b) {
  const maskL second = b.speed * a.gap > a.speed * b.gap;
  const approachL first = {blend(second, b.speed, a.speed), blend(second, b.gap, a.gap),
                           blend3(second, b.normal, a.normal)};
  return first;
}

// Facets that are looked at beside each other: a comparison waits for the one before it, those of other facets do not.
#define ABREAST 3

// Where a ray inside leaves.
static inline crossingL hull_exit(__global const real4 *facets, int count, vec3L origin, vec3L direction) {
  const vec3L nowhere = vec3(splat(0), splat(0), splat(0));
  approachL first[ABREAST];
  EACH (k, ABREAST) {
    first[k].speed = splat(0);
    first[k].gap = splat(1);
    first[k].normal = nowhere;
  }
  for (int i = 0; i < count; i += ABREAST)
    EACH (k, ABREAST) {
      const real4 facet = facets[min(i + k, count - 1)];
      const realL gap = fma(-origin.x, splat(facet.x),
                            fma(-origin.y, splat(facet.y), fma(-origin.z, splat(facet.z), splat(facet.w))));
      const approachL next = {dot_uniform(direction, facet), fmax(gap, splat(SMALLEST_GAP)),
                              vec3(splat(facet.x), splat(facet.y), splat(facet.z))};
      first[k] = sooner(first[k], next);
    }
  EACH (k, ABREAST) first[0] = sooner(first[0], first[k]);
  const crossingL crossing = {first[0].speed > 0, first[0].gap / fmax(first[0].speed, splat(PARALLEL)),
                              first[0].normal};
  return crossing;
}

// Whether the stone shades points of the room from a light: whether they lie behind all planes of its shadow volume, which
// the host makes of the silhouette's edges (and of the lit facets, where the stone reaches through a surface).
static inline maskL hull_shadow(__global const real4 *planes, int first, int last, vec3L point) {
  realL excess = splat(-1e30f);
  for (int i = first; i < last; i++) excess = fmax(excess, dot_uniform(point, planes[i]) - planes[i].w);
  return excess <= 0;
}

#endif
