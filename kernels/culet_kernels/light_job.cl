// What one light of one index of refraction does at one stone: a job.
#ifndef CULET_LIGHT_JOB
#define CULET_LIGHT_JOB
#include "landing.cl"

// What a job needs wherever light goes.
typedef struct {
  __constant const throwing_t *room;
  __constant const light_t *light;
  __constant const solid_t *solids, *solid; // all of them, and this one
  __global const chain_t *chains; // of the band that it has taken up, by solid's first_chain; null of a shadow
  facets_t facets;
  canvas_t canvas;
  float4 colour;
  float4 share;             // of each channel that is of its band
  __global float4 *seeping; // where it is counted, if its lamp is gauged
  real weight;              // mean of the channels of its colour,
  real power;               // and of their squares
  real eta;
  real absorption;          // per R
  real cutoff;              // flux, R^2
} job_t;

static inline real plane_of(const job_t *job, int k, int facet) {
  return job->facets.planes[job->solid->first_plane + k * job->solid->padded + facet];
}

// The part of a facet that lies before those surfaces of the room that hide it from its light. `corners` of a facet are its
// first, and those from `first` on.
static inline int facet_in_room(const job_t *job, int facet, int first, int corners, corner_t *part) {
  corner_t cut[2][CLIPPED];
  const int begin = job->facets.start[job->solid->first_facet + facet];
  int count = min(corners, CORNERS), side = 0;
  for (int i = 0; i < count; i++) {
    const int at = begin + (i == 0 ? 0 : first + i - 1);
    for (int k = 0; k < 3; k++) cut[0][i].p[k] = job->facets.vertices[3 * job->facets.corners[at] + k];
  }
  if (job->solid->pierces && job->light->inside < 0)
    for (int s = 0; s < MAX_SURFACES && count > 2; s++) {
      if (!job->room->present[s]) continue;
      real inside[CLIPPED];
      int out = 0;
      for (int i = 0; i < count; i++) {
        real way[3];
        for (int k = 0; k < 3; k++)
          way[k] = DIVERGING ? cut[side][i].p[k] - job->light->place[k] : -job->light->place[k];
        inside[i] = speed_to(job->room, s, way) > 0 ? gap_to(job->room, s, cut[side][i].p) : (real)1;
        out += inside[i] < 0;
      }
      if (!out) continue;
      count = clip_corners(cut[side], count, inside, cut[1 - side], CORNERS);
      side = 1 - side;
    }
  for (int i = 0; i < count; i++) part[i] = cut[side][i];
  return count;
}

// Whether a facet is lit, at all, from outside.
static inline int is_lit(const job_t *job, int facet) {
  real towards = 0;
  for (int k = 0; k < 3; k++) towards += plane_of(job, k, facet) * job->light->place[k];
  return DIVERGING ? towards > plane_of(job, 3, facet) && job->light->inside < 0 : towards > 0;
}

// That of this work-item.
static inline canvas_t canvas_of(__constant const throwing_t *room, __global float4 *light_maps,
                                 __global float *shade_maps, __global uint *lit_rows, __global uint *shaded_rows) {
  const size_t rows = (size_t)get_global_id(0) * room->maps * MAP_LEVELS * MAP_SIZE, of_points = rows * room->points;
  const canvas_t canvas = {light_maps + rows * MAP_STRIDE, shade_maps + of_points * MAP_STRIDE, lit_rows + rows,
                           shaded_rows + of_points};
  return canvas;
}

// The stone that light goes on in.
static inline void go_to(job_t *job, int solid) {
  job->solid = job->solids + solid;
  if (!job->chains) return;
  __global const chain_t *chain = job->chains + job->solid->first_chain;
  job->eta = chain->eta;
  job->absorption = chain->absorption;
}

static inline float4 light_colour(__constant const light_t *light) {
  return (float4)(light->colour[0], light->colour[1], light->colour[2], 0);
}

// Mean of the channels.
static inline real weight_of(float4 colour) { return (fabs(colour.x) + fabs(colour.y) + fabs(colour.z)) / 3; }

// Of its shadow, until it takes up a band.
static inline job_t job_of(__constant const throwing_t *room, __constant const light_t *light,
                           __constant const solid_t *solids, int solid, facets_t facets, canvas_t canvas) {
  job_t job;
  job.room = room;
  job.light = light;
  job.solids = solids;
  job.chains = 0;
  job.facets = facets;
  job.canvas = canvas;
  job.colour = light_colour(light);
  job.weight = job.power = 1;
  job.eta = 1;
  job.share = 0;
  job.seeping = 0;
  job.absorption = 0;
  job.cutoff = room->cutoff * light->dimness;
  go_to(&job, solid);
  return job;
}

// Takes up the light of a band, whose chains these are.
static inline void take_band(job_t *job, __global const chain_t *chains) {
  job->chains = chains;
  go_to(job, job->solid - job->solids);
  __global const real *share = chains[job->solid->first_chain].share;
  job->share = (float4)((float)share[0], (float)share[1], (float)share[2], 0);
  job->colour = light_colour(job->light) * job->share;
  job->weight = weight_of(job->colour);
  job->power = dot(job->colour, job->colour) / 3;
}

#endif
