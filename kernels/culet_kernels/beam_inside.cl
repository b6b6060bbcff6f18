// A beam inside a convex stone: what of it leaves by which facet, what is reflected, what meets another stone, and where it
// lands, until what is left is fainter than the cut-off.
#include "light_shadow.cl"

#include "polarisation.cl"

#ifndef SEVERAL // 1: there are several stones
#define SEVERAL 0
#endif
#if POLARISED
typedef polarisationL polarity_t;
static inline polarity_t unpolarised_light(const real *d) { return unpolarised(vec3(d[0], d[1], d[2])); }
#else
typedef int polarity_t; // nothing
static inline polarity_t unpolarised_light(const real *d) { return 0; }
#endif
#define COARSER ((real)3)    // times the cut-off: of lamps that are followed only to gauge their shadows
#define NO_FACET (-1)        // of a beam that begins inside the stone
#define PINHOLE ((real)1e-3) // part of the way from a light inside a stone to its facets at which its beams begin
#define FAINT ((real)0.1)    // cut-offs below which a beam that may meet another stone ends

typedef struct {
  real d[3];
  real flux;
  int count, facet;
  polarity_t polarity; // of light that goes as the beam does; its frame is about that way
#if SEVERAL
  int solid;           // that it is in, or has left
  int outside;         // it has left the stone
  int doubtful;
#endif
  corner_t corner[CORNERS];
} beam_t;

// A polygon on the plane in which it is cut.
typedef struct {
  real x[CORNERS + 2], y[CORNERS + 2];
#if DIVERGING
  real dx[CORNERS + 2], dy[CORNERS + 2], dz[CORNERS + 2], a[CORNERS + 2], b[CORNERS + 2];
#endif
} flat_t;

// What becomes of light at a boundary: the part that is reflected, and the polarisation of both.
typedef struct {
  real reflected;
  polarity_t mirrored, through;
} boundary_t;

// `squared` is the square of the cosine in air, by Snell's law; not positive where light is totally reflected.
static inline boundary_t at_boundary(const job_t *job, polarity_t polarity, const real *d, const real *normal,
                                     real cos_a, real cos_s, real squared) {
  boundary_t found;
#if POLARISED
  const vec3L way = vec3(d[0], d[1], d[2]), across = vec3(normal[0], normal[1], normal[2]);
  const splitL parts = split(align(polarity, way, across), cos_a, cos_s, squared, job->eta);
  found.reflected = parts.kept;
  found.mirrored = parts.reflected;
  found.through = parts.transmitted;
#else
  found.mirrored = found.through = polarity;
  found.reflected = squared > 0 ? reflectance(job->room->fresnel_kind, cos_a, cos_s, job->eta) : (real)1;
#endif
  return found;
}

#if DIVERGING
#define LEAST_SINE                                                                                                     \
  ((real)1e-6)             // squared cosine in air at which a corner's ray, past the critical angle, leaves instead
#define STEEP ((real)1e-3) // cosine to a facet below which a corner's ray meets it too far away
// Refraction outward.
static inline void refract_out(const real *d, const real *normal, real eta, real *out) {
  real unit[3] = {d[0], d[1], d[2]};
  normalise_3(unit);
  const real cos_s = dot_3(unit, normal), cos_a = sqrt(fmax(1 - eta * eta * (1 - cos_s * cos_s), LEAST_SINE));
  for (int k = 0; k < 3; k++) out[k] = eta * unit[k] + (cos_a - eta * cos_s) * normal[k];
}
#endif

static inline void copy_point(flat_t *to, int at, const flat_t *from, int i) {
  to->x[at] = from->x[i];
  to->y[at] = from->y[i];
#if DIVERGING
  to->dx[at] = from->dx[i];
  to->dy[at] = from->dy[i];
  to->dz[at] = from->dz[i];
  to->a[at] = from->a[i];
  to->b[at] = from->b[i];
#endif
}

static inline void mix_points(flat_t *to, int at, const flat_t *from, int i, int j, real part) {
  to->x[at] = mix_of(from->x[i], from->x[j], part);
  to->y[at] = mix_of(from->y[i], from->y[j], part);
#if DIVERGING
  to->dx[at] = mix_of(from->dx[i], from->dx[j], part);
  to->dy[at] = mix_of(from->dy[i], from->dy[j], part);
  to->dz[at] = mix_of(from->dz[i], from->dz[j], part);
  to->a[at] = mix_of(from->a[i], from->a[j], part);
  to->b[at] = mix_of(from->b[i], from->b[j], part);
#endif
}

static inline real flat_area(const flat_t *flat, int count) {
#if DIVERGING
  return fabs(polygon_area(flat->a, flat->b, count));
#else
  return fabs(polygon_area(flat->x, flat->y, count));
#endif
}

// The two axes along which a plane is seen best.
static inline void axes_of(const real *normal, int *k, int *u, int *v) {
  const real x = fabs(normal[0]), y = fabs(normal[1]), z = fabs(normal[2]);
  *k = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
  *u = *k == 0 ? 1 : *k == 1 ? 2 : 0;
  *v = *k == 0 ? 2 : *k == 1 ? 0 : 1;
}

// What a lamp's light that lands in its own shadow adds up to: all a lamp without flecks is followed for.
static inline void gauge(const job_t *job, const corner_t *corners, int count, const real *d, real flux) {
  real middle[3], way[3], reach, spread, first = 1e30f;
  middle_of(corners, count, d, middle, way, &reach, &spread);
  int met = NOBODY;
  for (int s = 0; s < MAX_SURFACES; s++) {
    if (!job->room->present[s]) continue;
    const real speed = speed_to(job->room, s, way), gap = gap_to(job->room, s, middle);
    if (speed < GRAZING || gap < 0 || gap >= first * speed) continue;
    first = gap / speed;
    met = s;
  }
  if (met == NOBODY || !job->room->mapped[met]) return;
  real towards[3];
  for (int k = 0; k < 3; k++) {
    middle[k] += first * way[k];
    towards[k] = job->light->place[k] - (DIVERGING ? middle[k] : 0);
  }
  normalise_3(towards);
  for (int s = 0; s < job->room->stones; s++) {
    real in, out;
    if (!crossing_of(job, s, middle, towards, &in, &out) || out <= 0) continue;
    *job->seeping += job->share * (float)flux;
    return;
  }
}

// Light that has left the last stone.
static inline void land_beam(const job_t *job, tally_t *tally, const corner_t *corners, int count, const real *d,
                             real flux, int doubtful) {
  if (job->light->gauges)
    gauge(job, corners, count, d, flux);
  else
    land(job->room, job->canvas, tally, job->light, corners, count, d, flux, job->colour, job->weight, job->power,
         doubtful, LIGHT_ITSELF);
}

// Light that leaves the stone. If another may be in its way, it waits until that is looked into.
static inline void leave(const job_t *job, tally_t *tally, beam_t *stack, int *top, const corner_t *corners, int count,
                         const real *d, real flux, polarity_t polarity, int doubtful) {
#if SEVERAL
  real middle[3], along[3], reach, spread;
  middle_of(corners, count, d, middle, along, &reach, &spread);
  ulong passed = 1ul << (job->solid - job->solids);
  if (nearest_sphere(job, middle, along, reach, spread, (real)1e30, &passed) != NOBODY) {
    if (flux < FAINT * job->cutoff)
      tally->cut += job->weight * flux;
    else if (*top >= BEAMS)
      tally->unresolved += job->weight * flux;
    else {
      beam_t *beam = stack + (*top)++;
      beam->flux = flux;
      beam->count = count;
      beam->solid = job->solid - job->solids;
      beam->outside = 1;
      beam->polarity = polarity;
      beam->doubtful = doubtful;
      for (int k = 0; k < 3; k++) beam->d[k] = d[k];
      for (int i = 0; i < count; i++) beam->corner[i] = corners[i];
    }
    return;
  }
#endif
  land_beam(job, tally, corners, count, d, flux, doubtful);
}

#define ABREAST 16 // planes that are looked at at a time, as the host fills them up
typedef JOIN(REAL, ABREAST) abreast_t;
typedef JOIN(MASK, ABREAST) numbers_t;

// The facet that a ray inside meets first, but for the one that it comes from: that of the largest speed / gap, compared
// without dividing. -1 if it meets none.
static inline int facet_ahead(__global const real *planes, int padded, const real *p, const real *d, int from) {
  abreast_t speeds = 0, gaps = 1;
  numbers_t found = -1, number = (numbers_t)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int f = 0; f < padded; f += ABREAST, number += ABREAST) {
    const abreast_t x = vload16(0, planes + f), y = vload16(0, planes + padded + f),
                    z = vload16(0, planes + 2 * padded + f), offset = vload16(0, planes + 3 * padded + f);
    const abreast_t speed = d[0] * x + d[1] * y + d[2] * z,
                    gap = fmax(offset - (p[0] * x + p[1] * y + p[2] * z), (real)1e-7);
    const numbers_t sooner = (speed * gaps > speeds * gap) & (number != from);
    speeds = sooner ? speed : speeds;
    gaps = sooner ? gap : gaps;
    found = sooner ? number : found;
  }
  const abreast_t rate = speeds / gaps;
  const JOIN(REAL, 8) of_8 = fmax(rate.lo, rate.hi);
  const real4 of_4 = fmax(of_8.lo, of_8.hi);
  const real best = fmax(fmax(of_4.x, of_4.y), fmax(of_4.z, of_4.w));
  if (!(best > 0)) return -1;
  const numbers_t those = rate == best ? found : (numbers_t)INT_MAX;
  const JOIN(MASK, 8) least_8 = min(those.lo, those.hi);
  const JOIN(MASK, 4) least_4 = min(least_8.lo, least_8.hi);
  return (int)min(min(least_4.x, least_4.y), min(least_4.z, least_4.w));
}

// One beam inside the stone: parts of it meet facets, where they leave, and are reflected as beams of their own.
static inline void split_beam(const job_t *job, tally_t *tally, beam_t *stack, int *top) {
  const beam_t beam = stack[--*top];
  const real d0 = beam.d[0], d1 = beam.d[1], d2 = beam.d[2], eta = job->eta;
  const int padded = job->solid->padded, count = beam.count;
  __global const real *nx = job->facets.planes + job->solid->first_plane, *ny = nx + padded, *nz = ny + padded,
                      *offset = nz + padded;
  tally->beams++;
  // The facet under the middle of the beam.
  real c0 = 0, c1 = 0, c2 = 0;
  for (int i = 0; i < count; i++) {
    c0 += beam.corner[i].p[0];
    c1 += beam.corner[i].p[1];
    c2 += beam.corner[i].p[2];
  }
  c0 /= count;
  c1 /= count;
  c2 /= count;
  const real middle[3] = {c0, c1, c2};
  const int first = facet_ahead(nx, padded, middle, beam.d, beam.facet);
  if (first < 0) {
    tally->unresolved += job->weight * beam.flux;
    return;
  }
  flat_t flat[2];
#if DIVERGING
  real area = 0;
  for (int i = 1; i + 1 < count; i++)
    area += (beam.corner[i].a - beam.corner[0].a) * (beam.corner[i + 1].b - beam.corner[0].b) -
            (beam.corner[i + 1].a - beam.corner[0].a) * (beam.corner[i].b - beam.corner[0].b);
  area = (real)0.5 * fabs(area);
  int k, u, v;
#else
  // The beam seen along its direction, without the direction's largest component.
  int k, u, v;
  axes_of(beam.d, &k, &u, &v);
  const real ru = beam.d[u] / beam.d[k], rv = beam.d[v] / beam.d[k], turn = beam.d[k] > 0 ? 1 : -1;
  flat_t seen;
  for (int i = 0; i < count; i++) {
    seen.x[i] = beam.corner[i].p[u] - ru * beam.corner[i].p[k];
    seen.y[i] = beam.corner[i].p[v] - rv * beam.corner[i].p[k];
  }
  const real area = flat_area(&seen, count);
#endif
  if (!(area > 0)) {
    tally->unresolved += job->weight * beam.flux;
    return;
  }
  const real per_area = beam.flux / area;
  ulong queued[MOST_FACETS / 64 + 1];
  for (int i = 0; i <= MOST_FACETS / 64; i++) queued[i] = 0;
  int queue[MOST_FACETS], head = 0, tail = 0;
  queued[first >> 6] |= 1ul << (first & 63);
  queue[tail++] = first;
  real given = 0;
  while (head < tail) {
    const int f = queue[head++];
    const real normal[3] = {nx[f], ny[f], nz[f]}, speed = normal[0] * d0 + normal[1] * d1 + normal[2] * d2;
    int left = count, side = 0, gone = 0;
#if DIVERGING
    if (speed <= STEEP || f == beam.facet) continue;
    axes_of(normal, &k, &u, &v);
    const real turn = normal[k] > 0 ? 1 : -1;
    for (int i = 0; i < count; i++) {
      const real *p = beam.corner[i].p, *d = beam.corner[i].d;
      const real t = (offset[f] - dot_3(normal, p)) / fmax(dot_3(normal, d), STEEP);
      flat[0].x[i] = p[u] + t * d[u];
      flat[0].y[i] = p[v] + t * d[v];
      flat[0].dx[i] = d[0];
      flat[0].dy[i] = d[1];
      flat[0].dz[i] = d[2];
      flat[0].a[i] = beam.corner[i].a;
      flat[0].b[i] = beam.corner[i].b;
    }
#define SEEN_X(vertex) vertex[u]
#define SEEN_Y(vertex) vertex[v]
#else
    if (speed <= (real)1e-7 || f == beam.facet) continue;
    for (int i = 0; i < count; i++) {
      flat[0].x[i] = seen.x[i];
      flat[0].y[i] = seen.y[i];
    }
#define SEEN_X(vertex) (vertex[u] - ru * vertex[k])
#define SEEN_Y(vertex) (vertex[v] - rv * vertex[k])
#endif
    const int begin = job->facets.start[job->solid->first_facet + f],
              end = job->facets.start[job->solid->first_facet + f + 1];
    __global const real *vertex = job->facets.vertices + 3 * job->facets.corners[end - 1];
    real x = SEEN_X(vertex), y = SEEN_Y(vertex);
    for (int e = begin, before = end - 1; e < end; before = e++) {
      vertex = job->facets.vertices + 3 * job->facets.corners[e];
      const real next_x = SEEN_X(vertex), next_y = SEEN_Y(vertex), along_x = (next_x - x) * turn,
                 along_y = (next_y - y) * turn;
      real inside[CORNERS + 2];
      int out = 0;
      for (int i = 0; i < left; i++) {
        inside[i] = along_x * (flat[side].y[i] - y) - along_y * (flat[side].x[i] - x);
        out += inside[i] < 0;
      }
      x = next_x;
      y = next_y;
      if (!out) continue;
      const int beyond = job->facets.across[before];
      if (!(queued[beyond >> 6] >> (beyond & 63) & 1)) {
        queued[beyond >> 6] |= 1ul << (beyond & 63);
        queue[tail++] = beyond;
      }
      if (out == left) {
        gone = 1;
        break;
      }
      int kept = 0;
      for (int i = 0; i < left; i++) {
        const int next = i + 1 == left ? 0 : i + 1;
        if (inside[i] >= 0) copy_point(&flat[1 - side], kept++, &flat[side], i);
        if ((inside[i] < 0) != (inside[next] < 0))
          mix_points(&flat[1 - side], kept++, &flat[side], i, next, inside[i] / (inside[i] - inside[next]));
      }
      side = 1 - side;
      left = min(kept, CORNERS);
    }
    if (gone || left < 3) continue;
    const real part = flat_area(&flat[side], left);
    if (!(part > 0)) continue;
    const real arriving = per_area * part;
    given += arriving;
#if DIVERGING
    real d[3] = {0, 0, 0};
    for (int i = 0; i < left; i++) {
      d[0] += flat[side].dx[i];
      d[1] += flat[side].dy[i];
      d[2] += flat[side].dz[i];
    }
    normalise_3(d);
    const real cos_s = fmin(dot_3(normal, d), (real)1);
#else
    const real *d = beam.d;
    const real cos_s = fmin(speed, (real)1);
#endif
    real flux = arriving;
    if (job->absorption > 0) { // along the ray in the middle
      real middle[3] = {0, 0, 0};
      for (int i = 0; i < left; i++) {
        middle[u] += flat[side].x[i] / left;
        middle[v] += flat[side].y[i] / left;
      }
      const int start = max(beam.facet, 0);
      const real from[3] = {nx[start], ny[start], nz[start]};
#if DIVERGING
      middle[k] = (offset[f] - normal[u] * middle[u] - normal[v] * middle[v]) / normal[k];
#endif
      // Of the line through the middle: how far it is from one facet's plane to the other's.
      const real far = (offset[f] - dot_3(normal, middle)) / dot_3(normal, d);
      real near = 0;
      if (beam.facet == NO_FACET)
        for (int i = 0; i < 3; i++) near += (job->light->place[i] - middle[i]) * d[i];
      else
        near = (offset[beam.facet] - dot_3(from, middle)) / fmin(dot_3(from, d), (real)-1e-7);
      flux *= exp(-job->absorption * fmax(far - near, (real)0));
      tally->absorbed += job->weight * (arriving - flux);
    }
    const real squared = 1 - eta * eta * (1 - cos_s * cos_s);
    const int exits = squared > 0;
    const real cos_a = sqrt(fmax(squared, (real)0));
    const boundary_t boundary = at_boundary(job, beam.polarity, d, normal, cos_a, cos_s, squared);
    const real reflected = boundary.reflected;
    const real rest = reflected * flux;
    const int goes = rest >= job->cutoff && *top < BEAMS - SEVERAL; // what leaves may wait, too
    if (!goes) tally->cut += job->weight * rest;
    if (!exits && !goes) continue;
    corner_t corner[CORNERS];
    for (int i = 0; i < left; i++) {
#if DIVERGING
      corner[i].p[u] = flat[side].x[i];
      corner[i].p[v] = flat[side].y[i];
      corner[i].p[k] = (offset[f] - normal[u] * flat[side].x[i] - normal[v] * flat[side].y[i]) / normal[k];
      corner[i].a = flat[side].a[i];
      corner[i].b = flat[side].b[i];
#else
      const real height = (offset[f] - normal[u] * flat[side].x[i] - normal[v] * flat[side].y[i]) / speed;
      corner[i].p[k] = d[k] * height;
      corner[i].p[u] = flat[side].x[i] + d[u] * height;
      corner[i].p[v] = flat[side].y[i] + d[v] * height;
#endif
    }
    if (exits) {
      const real g = cos_a - eta * cos_s,
                 out[3] = {eta * d[0] + g * normal[0], eta * d[1] + g * normal[1], eta * d[2] + g * normal[2]};
#if DIVERGING
      for (int i = 0; i < left; i++) {
        const real own[3] = {flat[side].dx[i], flat[side].dy[i], flat[side].dz[i]};
        refract_out(own, normal, eta, corner[i].d);
      }
#endif
      leave(job, tally, stack, top, corner, left, out, (1 - reflected) * flux, boundary.through,
            beam.flux < 3 * job->cutoff);
    }
    if (goes) {
      beam_t *next = stack + (*top)++;
      next->polarity = boundary.mirrored;
#if SEVERAL
      next->solid = beam.solid;
      next->outside = 0;
#endif
      next->count = left;
      next->facet = f;
      next->flux = rest;
      for (int i = 0; i < 3; i++) next->d[i] = d[i] - 2 * cos_s * normal[i];
      normalise_3(next->d);
      for (int i = 0; i < left; i++) {
#if DIVERGING
        const real own[3] = {flat[side].dx[i], flat[side].dy[i], flat[side].dz[i]}, twice = 2 * dot_3(own, normal);
        for (int j = 0; j < 3; j++) corner[i].d[j] = own[j] - twice * normal[j];
#endif
        next->corner[i] = corner[i];
      }
    }
  }
  tally->unresolved += job->weight * (beam.flux - given);
}

#if SEVERAL
// A beam outside that meets another stone: a part on each of its facets.
static inline void meet(const job_t *job, tally_t *tally, beam_t *stack, int *top, const piece_t *piece,
                        const real *common, real flux, polarity_t polarity, int doubtful) {
  const real whole = fmax(measure(piece->corner, piece->count), (real)1e-30), eta = job->eta;
  real middle[3], along[3], reach, spread, given = 0;
  middle_of(piece->corner, piece->count, common, middle, along, &reach, &spread);
  for (int f = 0; f < job->solid->facets; f++) {
    const real normal[3] = {plane_of(job, 0, f), plane_of(job, 1, f), plane_of(job, 2, f)},
               offset = plane_of(job, 3, f);
    if (dot_3(normal, along) >= -GRAZING) continue;
    const int begin = job->facets.start[job->solid->first_facet + f],
              end = job->facets.start[job->solid->first_facet + f + 1];
    corner_t cut[2][CORNERS];
    int side = 0, count = piece->count;
    for (int i = 0; i < count; i++) cut[0][i] = piece->corner[i];
    for (int e = begin; e < end && count > 2; e++) {
      real inside[CORNERS];
      const int out = beside(job, job->facets.corners[e], job->facets.corners[e + 1 == end ? begin : e + 1], cut[side],
                             count, common, inside);
      if (!out) continue;
      count = out < count ? clip_corners(cut[side], count, inside, cut[1 - side], CORNERS) : 0;
      side = 1 - side;
    }
    if (count < 3) continue;
    corner_t *corner = cut[side];
    const real arriving = flux * fmin(measure(corner, count) / whole, (real)1);
    given += arriving;
    corner_t mirrored[CORNERS];
    real unused[3], d[3];
    middle_of(corner, count, common, unused, d, &reach, &spread);
    const real cos_a = fmax(-dot_3(d, normal), GRAZING), cos_s = sqrt(1 - (1 - cos_a * cos_a) / (eta * eta));
    const boundary_t boundary = at_boundary(job, polarity, d, normal, cos_a, cos_s, cos_a * cos_a);
    const real reflected = boundary.reflected;
    real out[3], inward[3];
    for (int k = 0; k < 3; k++) {
      out[k] = d[k] + 2 * cos_a * normal[k];
      inward[k] = d[k] / eta + (cos_a / eta - cos_s) * normal[k];
    }
    for (int i = 0; i < count; i++) {
      const real *own = way_of(corner + i, common);
      const real t = (offset - dot_3(normal, corner[i].p)) / fmin(dot_3(normal, own), -GRAZING);
      for (int k = 0; k < 3; k++) corner[i].p[k] += t * own[k];
      mirrored[i] = corner[i];
#if DIVERGING
      real way[3] = {own[0], own[1], own[2]};
      normalise_3(way);
      const real cosine = fmax(-dot_3(way, normal), GRAZING), inner = sqrt(1 - (1 - cosine * cosine) / (eta * eta));
      for (int k = 0; k < 3; k++) {
        mirrored[i].d[k] = way[k] + 2 * cosine * normal[k];
        corner[i].d[k] = way[k] / eta + (cosine / eta - inner) * normal[k];
      }
#endif
    }
    leave(job, tally, stack, top, mirrored, count, out, reflected * arriving, boundary.mirrored, doubtful);
    const real rest = (1 - reflected) * arriving;
    if (rest < job->cutoff || *top >= BEAMS) {
      tally->cut += job->weight * rest;
      continue;
    }
    beam_t *beam = stack + (*top)++;
    beam->flux = rest;
    beam->count = count;
    beam->facet = f;
    beam->solid = job->solid - job->solids;
    beam->outside = 0;
    beam->polarity = boundary.through;
    for (int k = 0; k < 3; k++) beam->d[k] = inward[k];
    for (int i = 0; i < count; i++) beam->corner[i] = corner[i];
  }
  tally->unresolved += job->weight * (flux - given);
}

// A beam outside: parts of it meet other stones, parts pass them all.
static inline void fly(job_t *job, tally_t *tally, beam_t *stack, int *top) {
  const beam_t beam = stack[--*top];
  flight_t flight;
  begin_flight(&flight, beam.corner, beam.count, beam.solid);
  const real whole = fmax(measure(beam.corner, beam.count), (real)1e-30);
  real left = beam.flux;
  while (flight.waiting > 0) {
    piece_t part;
    const int met = next_part(job, &flight, beam.d, (real)1e30, &part);
    const real flux = fmin(beam.flux * (measure(part.corner, part.count) / whole), left);
    left -= flux;
    if (met == NOBODY)
      land_beam(job, tally, part.corner, part.count, beam.d, flux, beam.doubtful);
    else if (met == LOST)
      tally->unresolved += job->weight * flux;
    else {
      go_to(job, met);
      meet(job, tally, stack, top, &part, beam.d, flux, beam.polarity, beam.doubtful);
    }
  }
  tally->unresolved += job->weight * left;
}
#endif

// Follows all beams of the stack.
static inline void follow(job_t *job, tally_t *tally, beam_t *stack, int top) {
  while (top > 0) {
#if SEVERAL
    go_to(job, stack[top - 1].solid);
    if (stack[top - 1].outside) {
      fly(job, tally, stack, &top);
      continue;
    }
#endif
    split_beam(job, tally, stack, &top);
  }
}
