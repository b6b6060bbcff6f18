// The shadows of convex stones: what stands between a light and the room is taken from the light of floor and walls.
#ifndef CULET_LIGHT_SHADOW
#define CULET_LIGHT_SHADOW
#include "exchange.cl"

#define NO_CORNER 0xffff

// A polygon of the stone's surface, seen by the light, takes its light from wherever its rays would have gone on to.
static inline void shade(const job_t *job, corner_t *corners, int count) {
  tally_t none = {0};
  real common[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) common[k] = -job->light->place[k];
#if DIVERGING
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) corners[i].d[k] = corners[i].p[k] - job->light->place[k];
#endif
  land(job->room, job->canvas, &none, job->light, corners, count, common, 0, job->colour, 1, 1, 0, SHADOW_OF_LIGHT);
}

// The outline of a stone, from its lit facets' sides to unlit ones. Returns whether that is one closed line, which it is but
// for facets that are seen edge-on; else nothing is done.
static inline int shade_outline(const job_t *job) {
  ushort following[2 * MOST_FACETS], outline[2 * MOST_FACETS];
  const int base = job->solid->first_vertex;
  for (int i = 0; i < job->solid->vertices; i++) following[i] = NO_CORNER;
  int sides = 0, begins = 0;
  ulong lit[MOST_FACETS / 64 + 1];
  for (int i = 0; i <= MOST_FACETS / 64; i++) lit[i] = 0;
  for (int f = 0; f < job->solid->facets; f++) lit[f >> 6] |= (ulong)is_lit(job, f) << (f & 63);
  for (int f = 0; f < job->solid->facets; f++) {
    if (!(lit[f >> 6] >> (f & 63) & 1)) continue;
    const int begin = job->facets.start[job->solid->first_facet + f],
              end = job->facets.start[job->solid->first_facet + f + 1];
    for (int e = begin; e < end; e++) {
      const int beyond = job->facets.across[e];
      if (lit[beyond >> 6] >> (beyond & 63) & 1) continue;
      const int from = job->facets.corners[e] - base, to = job->facets.corners[e + 1 == end ? begin : e + 1] - base;
      if (following[from] != NO_CORNER) return 0;
      following[from] = to;
      begins = from;
      sides++;
    }
  }
  if (sides < 3) return sides == 0;
  int at = begins;
  for (int i = 0; i < sides; i++) {
    outline[i] = at;
    at = following[at];
    if (at == NO_CORNER || (at == begins && i + 1 < sides)) return 0;
  }
  if (at != begins) return 0;
  corner_t corner[CORNERS];
  for (int first = 1; first + 1 < sides; first += CORNERS - 2) { // parts of it, as a fan about its first corner
    const int count = 1 + min(CORNERS - 1, sides - first);
    for (int i = 0; i < count; i++)
      for (int k = 0; k < 3; k++)
        corner[i].p[k] = job->facets.vertices[3 * (base + outline[i == 0 ? 0 : first + i - 1]) + k];
    shade(job, corner, count);
  }
  return 1;
}

// The parts of a facet that the light reaches past the other stones.
static inline void begin_lighting(const job_t *job, const corner_t *corners, int count, flight_t *flight) {
  begin_flight(flight, corners, count, job->solid - job->solids);
#if DIVERGING
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) flight->piece[0].corner[i].d[k] = job->light->place[k] - corners[i].p[k];
#endif
}

// The next of them. Returns whether there is one.
static inline int next_lit(const job_t *job, flight_t *flight, piece_t *part) {
  const real towards[3] = {job->light->place[0], job->light->place[1], job->light->place[2]};
  while (flight->waiting > 0) {
    real limit = 1e30f;
#if DIVERGING
    real way[3];
    for (int k = 0; k < 3; k++) way[k] = towards[k] - flight->piece[flight->waiting - 1].corner[0].p[k];
    limit = sqrt(dot_3(way, way));
#endif
    if (next_part(job, flight, towards, limit, part) == NOBODY) return 1;
  }
  return 0;
}

#endif
