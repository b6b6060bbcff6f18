// Several stones: which of them a beam outside meets first, and what of it passes. A polygon is cut by the outlines of the
// stones in its way; what is inside an outline belongs to that stone, and what is outside is cut further, into convex parts.
#ifndef CULET_EXCHANGE
#define CULET_EXCHANGE
#include "light_job.cl"

#define NOBODY (-1)
#define PIECES 24             // of a polygon that wait to be cut further, at most
#define LOST (-2)             // in place of a stone: more pieces than that
#define TOUCHING ((real)1e-5) // R of a stone's way that count as none
#define AHEAD ((real) - 1e-5) // R, and
#define SUNK ((real)1e-3) // radii that a stone may begin before the facet that a beam comes from, and be entered there

typedef struct {
  corner_t corner[CORNERS];
  int count;
  ulong passed; // the stones that it is known to miss, a bit each
} piece_t;

typedef struct {
  piece_t piece[PIECES];
  int waiting;
} flight_t;

// The middle of a polygon, its rays' direction there, how far its corners are from there, and how far their directions.
static inline void middle_of(const corner_t *corners, int count, const real *common, real *middle, real *d, real *reach,
                             real *spread) {
  for (int k = 0; k < 3; k++) middle[k] = d[k] = 0;
  for (int i = 0; i < count; i++) {
    const real *own = way_of(corners + i, common), inverse = rsqrt(fmax(dot_3(own, own), (real)1e-30));
    for (int k = 0; k < 3; k++) {
      middle[k] += corners[i].p[k] / count;
      d[k] += own[k] * inverse;
    }
  }
  normalise_3(d);
  *reach = *spread = 0;
  for (int i = 0; i < count; i++) {
    const real *own = way_of(corners + i, common), inverse = rsqrt(fmax(dot_3(own, own), (real)1e-30));
    real apart = 0, turned = 0;
    for (int k = 0; k < 3; k++) {
      apart += (corners[i].p[k] - middle[k]) * (corners[i].p[k] - middle[k]);
      turned += (own[k] * inverse - d[k]) * (own[k] * inverse - d[k]);
    }
    *reach = fmax(*reach, apart);
    *spread = fmax(*spread, turned);
  }
  *reach = sqrt(*reach);
  *spread = DIVERGING ? sqrt(*spread) : 0;
}

// Of the stones that a beam may meet, the one whose sphere begins first. Those that it surely misses are marked in `passed`.
static inline int nearest_sphere(const job_t *job, const real *middle, const real *d, real reach, real spread,
                                 real limit, ulong *passed) {
  int found = NOBODY;
  real first = 1e30f;
  for (int s = 0; s < job->room->stones; s++) {
    if (*passed >> s & 1) continue;
    __constant const solid_t *solid = job->solids + s;
    real apart[3];
    for (int k = 0; k < 3; k++) apart[k] = solid->centre[k] - middle[k];
    const real along = dot_3(apart, d), wide = solid->radius * (real)1.0001 + reach + spread * fmax(along, (real)0);
    if (along < -wide || along - wide > limit || dot_3(apart, apart) - along * along > wide * wide) {
      *passed |= 1ul << s;
      continue;
    }
    if (along - solid->radius < first) {
      first = along - solid->radius;
      found = s;
    }
  }
  return found;
}

static inline real plane_at(const job_t *job, int solid, int k, int facet) {
  __constant const solid_t *of = job->solids + solid;
  return job->facets.planes[of->first_plane + k * of->padded + facet];
}

// Where a ray goes into a stone and out of it. Returns whether it meets the stone.
static inline int crossing_of(const job_t *job, int solid, const real *p, const real *d, real *in, real *out) {
  *in = -1e30f;
  *out = 1e30f;
  __constant const solid_t *of = job->solids + solid;
  real apart[3];
  for (int k = 0; k < 3; k++) apart[k] = of->centre[k] - p[k];
  const real along = dot_3(apart, d), wide = of->radius * (real)1.0001;
  if (dot_3(apart, apart) - along * along > wide * wide) return 0; // past its sphere
  for (int f = 0; f < of->facets; f++) {
    const real normal[3] = {plane_at(job, solid, 0, f), plane_at(job, solid, 1, f), plane_at(job, solid, 2, f)};
    const real speed = dot_3(normal, d), gap = plane_at(job, solid, 3, f) - dot_3(normal, p);
    if (fabs(speed) < (real)1e-9) {
      if (gap < 0) return 0;
      continue;
    }
    if (speed < 0)
      *in = fmax(*in, gap / speed);
    else
      *out = fmin(*out, gap / speed);
  }
  return *in < *out;
}

// On which side of an edge, seen along its rays, each corner is: not negative to the left, looking along the rays.
static inline int beside(const job_t *job, int from, int to, const corner_t *corners, int count, const real *common,
                         real *inside) {
  __global const real *a = job->facets.vertices + 3 * from, *b = job->facets.vertices + 3 * to;
  const real edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  int out = 0;
  for (int i = 0; i < count; i++) {
    real across[3], apart[3];
    cross_3(edge, way_of(corners + i, common), across);
    for (int k = 0; k < 3; k++) apart[k] = corners[i].p[k] - a[k];
    inside[i] = dot_3(across, apart);
    out += inside[i] < 0;
  }
  return out;
}

// Cuts a piece by the outline of a stone, as the ray in the middle sees it. What is outside goes to the flight. Returns the
// number of corners of what is inside, which takes the place of the piece; 0, and nothing is done, if that is nothing.
static inline int cut_by_outline(const job_t *job, int solid, piece_t *piece, const real *common, const real *d,
                                 flight_t *flight, int *lost) {
  __constant const solid_t *of = job->solids + solid;
  corner_t now[2][CORNERS];
  int side = 0, count = piece->count;
  const int before = flight->waiting;
  for (int i = 0; i < count; i++) now[0][i] = piece->corner[i];
  ulong met[MOST_FACETS / 64 + 1];
  for (int i = 0; i <= MOST_FACETS / 64; i++) met[i] = 0;
  for (int f = 0; f < of->facets; f++) {
    const real speed =
        plane_at(job, solid, 0, f) * d[0] + plane_at(job, solid, 1, f) * d[1] + plane_at(job, solid, 2, f) * d[2];
    met[f >> 6] |= (ulong)(speed < 0) << (f & 63);
  }
  for (int f = 0; f < of->facets; f++) {
    if (!(met[f >> 6] >> (f & 63) & 1)) continue;
    const int begin = job->facets.start[of->first_facet + f], end = job->facets.start[of->first_facet + f + 1];
    for (int e = begin; e < end; e++) {
      const int beyond = job->facets.across[e];
      if (met[beyond >> 6] >> (beyond & 63) & 1) continue;
      real inside[CORNERS];
      const int out = beside(job, job->facets.corners[e], job->facets.corners[e + 1 == end ? begin : e + 1], now[side],
                             count, common, inside);
      if (!out) continue;
      if (out < count && flight->waiting < PIECES) {
        piece_t *outer = flight->piece + flight->waiting++;
        real outside[CORNERS];
        for (int i = 0; i < count; i++) outside[i] = -inside[i];
        outer->count = clip_corners(now[side], count, outside, outer->corner, CORNERS);
        outer->passed = piece->passed | 1ul << solid;
        if (outer->count < 3) flight->waiting--;
      } else if (out < count)
        *lost = 1;
      count = out < count ? clip_corners(now[side], count, inside, now[1 - side], CORNERS) : 0;
      side = 1 - side;
      if (count < 3) {
        flight->waiting = before;
        return 0;
      }
    }
  }
  piece->count = count;
  for (int i = 0; i < count; i++) piece->corner[i] = now[side][i];
  return count;
}

// The next part of what flies: the stone that `part` meets, NOBODY, or LOST. There must be some that waits. Only what begins
// before `limit` R counts.
static inline int next_part(const job_t *job, flight_t *flight, const real *common, real limit, piece_t *part) {
  *part = flight->piece[--flight->waiting];
  int wanted = NOBODY, lost = 0;
  for (int tries = 0; tries < 4 * MAX_STONES; tries++) {
    real middle[3], d[3], reach, spread;
    middle_of(part->corner, part->count, common, middle, d, &reach, &spread);
    ulong passed = part->passed;
    const int nearest = nearest_sphere(job, middle, d, reach, spread, limit, &passed);
    if (nearest == NOBODY) return NOBODY;
    part->passed = passed;
    const int solid = wanted == NOBODY ? nearest : wanted;
    wanted = NOBODY;
    piece_t inner = *part;
    const int before = flight->waiting;
    if (!cut_by_outline(job, solid, &inner, common, d, flight, &lost)) {
      part->passed |= 1ul << solid;
      continue;
    }
    real inner_middle[3], inner_d[3], in, out;
    middle_of(inner.corner, inner.count, common, inner_middle, inner_d, &reach, &spread);
    const int hit = crossing_of(job, solid, inner_middle, inner_d, &in, &out);
    if (!hit || out < TOUCHING || in > limit) { // it is behind, or beyond the light
      flight->waiting = before;
      part->passed |= 1ul << solid;
      continue;
    }
    if (in < AHEAD - SUNK * job->solids[solid].radius) lost = 1; // they overlap
    // Whether another one stands in front of it after all.
    real soonest = in;
    for (int s = 0; s < job->room->stones; s++) {
      real other_in, other_out;
      if (s == solid || part->passed >> s & 1) continue;
      if (crossing_of(job, s, inner_middle, inner_d, &other_in, &other_out) && other_out > 0 && other_in < soonest &&
          other_in > AHEAD) {
        soonest = other_in;
        wanted = s;
      }
    }
    if (wanted != NOBODY) {
      flight->waiting = before;
      continue;
    }
    *part = inner;
    return lost ? LOST : solid;
  }
  return LOST;
}

// Whether any other stone may be in the way of this one's light.
static inline int is_screened(const job_t *job) {
  real towards[3];
  for (int k = 0; k < 3; k++) towards[k] = job->light->place[k] - (DIVERGING ? job->solid->centre[k] : 0);
  const real far = DIVERGING ? sqrt(dot_3(towards, towards)) : 0;
  normalise_3(towards);
  ulong passed = 1ul << (job->solid - job->solids);
  const real centre[3] = {job->solid->centre[0], job->solid->centre[1], job->solid->centre[2]};
  return nearest_sphere(job, centre, towards, job->solid->radius, 0, DIVERGING ? far : (real)1e30, &passed) != NOBODY;
}

// A flight of one polygon that leaves a stone.
static inline void begin_flight(flight_t *flight, const corner_t *corners, int count, int from) {
  flight->waiting = 1;
  flight->piece[0].count = count;
  flight->piece[0].passed = 1ul << from;
  for (int i = 0; i < count; i++) flight->piece[0].corner[i] = corners[i];
}

#endif
