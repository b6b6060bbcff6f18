// The light that convex stones throw on floor and walls, by exact beams: all facets are planes, so light of one direction
// goes through a stone in beams with flat sides, each way through it a polygon of even light where it lands (Heckbert &
// Hanrahan, Beam tracing polygonal objects, SIGGRAPH 1984; Watt, Light-water interaction using backward beam tracing, 1990).
//
// A work-item takes one (facet, light, index of refraction) after another.
#include "beam_inside.cl"

// Light of a point comes to a facet in parts, in which directions differ little.
#define PARTS 24        // that wait, at most: each is half as wide as the one before the last
#define WORTH ((real)4) // cut-offs of flux below which a part is not cut further

#if DIVERGING
// Halves a polygon across its longest diagonal, if that is longer than so many distances from the light. Returns whether.
static inline int halve(const job_t *job, corner_t *part, int *count, corner_t *other, int *other_count) {
  int from = 0, to = 0;
  real longest = 0, nearest = 1e30f, middle[3] = {0, 0, 0};
  for (int i = 0; i < *count; i++) {
    real squared = 0;
    for (int k = 0; k < 3; k++) {
      const real way = part[i].p[k] - job->light->place[k];
      squared += way * way;
      middle[k] += way / *count;
    }
    nearest = fmin(nearest, squared);
    for (int j = 0; j < i; j++) {
      real apart = 0;
      for (int k = 0; k < 3; k++) apart += (part[i].p[k] - part[j].p[k]) * (part[i].p[k] - part[j].p[k]);
      if (apart > longest) {
        longest = apart;
        from = j;
        to = i;
      }
    }
  }
  nearest = fmin(nearest, dot_3(middle, middle));
  if (longest <= job->room->piece * job->room->piece * nearest) return 0;
  real inside[CORNERS], outside[CORNERS];
  for (int i = 0; i < *count; i++) {
    inside[i] = 0;
    for (int k = 0; k < 3; k++)
      inside[i] += (part[to].p[k] - part[from].p[k]) * ((real)0.5 * (part[from].p[k] + part[to].p[k]) - part[i].p[k]);
    outside[i] = -inside[i];
  }
  corner_t kept[CORNERS];
  const int left = clip_corners(part, *count, inside, kept, CORNERS);
  *other_count = clip_corners(part, *count, outside, other, CORNERS);
  for (int i = 0; i < left; i++) part[i] = kept[i];
  *count = left;
  return 1;
}
#endif

// Of a part of a facet: its rays inside, and mirrored outside, and the directions in the middle. Returns its flux.
static inline real begin_beam(const job_t *job, const real *normal, const corner_t *part, int count, beam_t *beam,
                              corner_t *mirrored, real *d) {
  beam->count = count;
#if DIVERGING
  const real eta = job->eta;
  int k, u, v;
  axes_of(normal, &k, &u, &v);
  real per_area = 0;
  for (int j = 0; j < 3; j++) d[j] = 0;
  for (int i = 0; i < count; i++) {
    corner_t *corner = beam->corner + i;
    real way[3];
    for (int j = 0; j < 3; j++) way[j] = part[i].p[j] - job->light->place[j];
    const real squared = fmax(dot_3(way, way), (real)1e-12);
    normalise_3(way);
    const real cos_a = fmax(job->light->inside < 0 ? -dot_3(way, normal) : dot_3(way, normal), GRAZING),
               cos_s = sqrt(1 - (1 - cos_a * cos_a) / (eta * eta));
    per_area += job->light->squared / squared * cos_a / count;
    for (int j = 0; j < 3; j++) {
      d[j] += way[j];
      mirrored[i].p[j] = corner->p[j] = part[i].p[j];
      corner->d[j] = way[j] / eta + (cos_a / eta - cos_s) * normal[j];
      mirrored[i].d[j] = way[j] + 2 * cos_a * normal[j];
    }
    mirrored[i].a = corner->a = part[i].p[u];
    mirrored[i].b = corner->b = part[i].p[v];
    if (job->light->inside < 0) continue;
    for (int j = 0; j < 3; j++) {
      corner->p[j] = mix_of(job->light->place[j], part[i].p[j], PINHOLE);
      corner->d[j] = way[j];
    }
  }
  normalise_3(d);
  return per_area / fabs(normal[k]) * (real)0.5 * measure(beam->corner, count);
#else
  for (int i = 0; i < count; i++) beam->corner[i] = mirrored[i] = part[i];
  for (int j = 0; j < 3; j++) d[j] = -job->light->place[j];
  return -dot_3(d, normal) * (real)0.5 * measure(part, count);
#endif
}

// Light that comes to a convex part of a facet from outside, or there from a point inside.
static inline void enter(job_t *job, tally_t *tally, int facet, const corner_t *part, int count) {
  beam_t stack[BEAMS];
  const int solid = job->solid - job->solids;
  const real normal[3] = {plane_of(job, 0, facet), plane_of(job, 1, facet), plane_of(job, 2, facet)}, eta = job->eta;
  corner_t mirrored[CORNERS];
#if DIVERGING
  corner_t parts[PARTS][CORNERS];
  int counts[PARTS], waiting = 1;
  for (int i = 0; i < count; i++) parts[0][i] = part[i];
  counts[0] = count;
  while (waiting > 0) {
    const corner_t *now = parts[waiting - 1];
    count = counts[waiting - 1];
    if (count < 3) {
      waiting--;
      continue;
    }
#else
  {
    const corner_t *now = part;
#endif
    real d[3];
    const real flux = begin_beam(job, normal, now, count, stack, mirrored, d);
#if DIVERGING
    if (waiting < PARTS && flux > WORTH * job->cutoff &&
        halve(job, parts[waiting - 1], counts + waiting - 1, parts[waiting], counts + waiting)) {
      waiting++;
      continue;
    }
    waiting--;
    if (!(flux > 0)) continue;
    if (job->light->inside >= 0) {
      tally->incident += job->weight * flux;
      for (int j = 0; j < 3; j++) stack->d[j] = d[j];
      stack->flux = flux;
      stack->facet = NO_FACET;
      stack->polarity = unpolarised_light(d);
#if SEVERAL
      stack->solid = solid;
      stack->outside = 0;
#endif
      if (flux < job->cutoff)
        tally->cut += job->weight * flux;
      else
        follow(job, tally, stack, 1);
      go_to(job, solid);
      continue;
    }
#else
    if (!(flux > 0)) return;
#endif
    const real cos_a = fmax(-dot_3(d, normal), DIVERGING ? GRAZING : (real)0);
    const real cos_s = sqrt(1 - (1 - cos_a * cos_a) / (eta * eta));
    const boundary_t boundary = at_boundary(job, unpolarised_light(d), d, normal, cos_a, cos_s, cos_a * cos_a);
    const real reflected = boundary.reflected;
    real out[3];
    for (int j = 0; j < 3; j++) out[j] = d[j] + 2 * cos_a * normal[j];
    tally->incident += job->weight * flux;
    const real through = (1 - reflected) * flux;
    int top = through >= job->cutoff;
    if (!top) tally->cut += job->weight * through;
    beam_t *beam = stack;
    for (int j = 0; j < 3; j++) beam->d[j] = d[j] / eta + (cos_a / eta - cos_s) * normal[j];
    beam->flux = through;
    beam->facet = facet;
    beam->polarity = boundary.through;
#if SEVERAL
    beam->solid = solid;
    beam->outside = 0;
#endif
    leave(job, tally, stack, &top, mirrored, count, out, reflected * flux, boundary.mirrored, 0);
    follow(job, tally, stack, top);
    go_to(job, solid);
  }
}

#define GEOMETRY_BUFFERS                                                                                               \
  __constant const throwing_t *room, __constant const light_t *lights, __constant const solid_t *solids,               \
      __global const real *planes, __global const real *vertices, __global const int *start,                           \
      __global const int *corners, __global const int *across, __global const int4 *entries,                           \
      __global const chain_t *chains, __global float4 *light_maps, __global float *shade_maps,                         \
      __global uint *lit_rows, __global uint *shaded_rows, __global float4 *seeping, __global tally_t *tallies
#define GEOMETRY_OF                                                                                                    \
  {                                                                                                                    \
    planes, vertices, start, corners, across                                                                           \
  }

// Bands of light that a job follows: of several stones all, since what reaches a facet past the others is the same for all.
typedef struct {
  __global const chain_t *chains; // of the first of all
  int first, end;
  int stands_for_all;             // of a lamp that is gauged
} bands_t;

// A band ends by how much of its light there is: of a red light the blue one much sooner, of a white one all alike.
static inline void enter_bands(job_t *job, tally_t *tally, bands_t bands, int facet, const corner_t *part, int count) {
  const real cutoff = job->cutoff, white = weight_of(light_colour(job->light));
  for (int band = bands.first; band < bands.end; band++) {
    take_band(job, bands.chains + band);
    if (!job->light->gauges) {
      if (!(job->weight > 0)) continue;
      job->cutoff = cutoff * white * weight_of(job->share) / job->weight;
      enter(job, tally, facet, part, count);
      job->cutoff = cutoff;
      continue;
    }
    tally_t own = {0};
    job->weight = 1;
    if (bands.stands_for_all) job->share = 1;
    enter(job, &own, facet, part, count);
    job->seeping[1] += job->share * (float)(own.incident - own.cut);
  }
}

// The light of a facet's part.
static inline void throw_at(job_t *job, tally_t *tally, bands_t bands, int4 entry) {
  const int facet = entry.y, inside = DIVERGING ? job->light->inside : -1;
  if (inside < 0 ? !is_lit(job, facet) : inside != entry.x) return;
  corner_t part[CORNERS];
  const int count = facet_in_room(job, facet, entry.z, entry.w, part);
  if (count < 3) return;
#if !DIVERGING
  // What is cut here would tell a gauge of nothing that goes through.
  if (job->light->gauges) {
    real towards = 0;
    for (int k = 0; k < 3; k++) towards += plane_of(job, k, facet) * job->light->place[k];
    if (towards * (real)0.5 * measure(part, count) < job->cutoff) return;
  }
#endif
#if SEVERAL
  if (inside < 0 && is_screened(job)) {
    flight_t flight;
    piece_t lit;
    begin_lighting(job, part, count, &flight);
    while (next_lit(job, &flight, &lit)) enter_bands(job, tally, bands, facet, lit.corner, lit.count);
    return;
  }
#endif
  enter_bands(job, tally, bands, facet, part, count);
}

// Jobs are dealt out by their numbers, and not to who is free first: so sums are rounded in the same order every time. Where
// each entry would begin with the same work-item, turns change from one to the next, lest a work-item have one band of all.
static inline int is_mine(int number, int of_entry) {
  const int items = get_global_size(0), turn = of_entry % items == 0 ? number + number / of_entry : number;
  return turn % items == (int)get_global_id(0);
}

// Jobs are numbered: of each entry the lights, of each light the bands, if they are apart.
static inline int jobs_of_entry(__constant const throwing_t *room) {
  return room->lights * (SEVERAL ? 1 : room->bands);
}
static inline bands_t bands_of(__constant const throwing_t *room, int number, __global const chain_t *chains) {
  const int one = number % room->bands;
  const bands_t bands = {chains, SEVERAL ? 0 : one, SEVERAL ? room->bands : one + 1, 0};
  return bands;
}
static inline __constant const light_t *light_of(__constant const throwing_t *room, int number,
                                                 __constant const light_t *lights) {
  return lights + number % jobs_of_entry(room) / (SEVERAL ? 1 : room->bands);
}

__kernel void throw_light(GEOMETRY_BUFFERS, int begin, int end) {
  tally_t tally = tallies[get_global_id(0)];
  const facets_t facets = GEOMETRY_OF;
  const canvas_t canvas = canvas_of(room, light_maps, shade_maps, lit_rows, shaded_rows);
  const int of_entry = jobs_of_entry(room);
  for (int number = begin; number < end; number++) {
    __constant const light_t *light = light_of(room, number, lights);
    if (!is_mine(number, of_entry) || !light->follows) continue;
    const int4 entry = entries[number / of_entry];
    job_t job = job_of(room, light, solids, entry.x, facets, canvas);
    throw_at(&job, &tally, bands_of(room, number, chains), entry);
  }
  tallies[get_global_id(0)] = tally;
}

// Follows lamps that make no flecks, coarsely, to find what part of their light goes through the stones into their shadows.
// `band`: 1 more than the number of the band that stands for all channels; 0: each stands for its own.
__kernel void gauge_light(GEOMETRY_BUFFERS, int begin, int end, int band) {
  const facets_t facets = GEOMETRY_OF;
  const canvas_t canvas = canvas_of(room, light_maps, shade_maps, lit_rows, shaded_rows);
  const int of_entry = jobs_of_entry(room);
  for (int number = begin; number < end; number++) {
    __constant const light_t *light = light_of(room, number, lights);
    if (!is_mine(number, of_entry) || !light->gauges) continue;
    bands_t bands = bands_of(room, number, chains);
    if (band > 0) {
      if (!SEVERAL && bands.first != band - 1) continue;
      bands.first = band - 1;
      bands.end = band;
      bands.stands_for_all = 1;
    }
    const int4 entry = entries[number / of_entry];
    job_t job = job_of(room, light, solids, entry.x, facets, canvas);
    job.cutoff *= COARSER;
    job.seeping = seeping + 2 * (get_global_id(0) * room->gauges + light->gauge);
    throw_at(&job, 0, bands, entry);
  }
}

// The part of a lamp's light that goes through the stones into its shadows, by channel: what beams above the cut-off say.
static inline float4 seeping_part(__constant const throwing_t *room, __constant const light_t *light,
                                  __global const float4 *seeping) {
  if (light->gauge < 0) return 0;
  float4 through = 0, followed = 0;
  for (int item = 0; item < get_global_size(0); item++) {
    __global const float4 *found = seeping + 2 * (item * room->gauges + light->gauge);
    through += found[0];
    followed += found[1];
  }
  return clamp(through / fmax(followed, 1e-20f), 0.0f, 1.0f);
}

// Shadows are numbered: of each stone the lights.
__kernel void cast_shadows(GEOMETRY_BUFFERS, int begin, int end) {
  const facets_t facets = GEOMETRY_OF;
  const canvas_t canvas = canvas_of(room, light_maps, shade_maps, lit_rows, shaded_rows);
  for (int number = begin; number < end; number++) {
    if (!is_mine(number, room->lights)) continue;
    job_t job = job_of(room, lights + number % room->lights, solids, number / room->lights, facets, canvas);
    if (job.light->inside >= 0) continue; // everything is in shadow
    job.colour *= 1 - seeping_part(room, job.light, seeping);
#if SEVERAL && !DIVERGING
    if (!room->sunk) {
      shade_beyond_earlier(&job);
      continue;
    }
#endif
    int alone = 1; // no other stone is in the way of its light
#if SEVERAL
    alone = !is_screened(&job);
#endif
    if (!job.solid->pierces && alone && shade_outline(&job)) continue;
    for (int entry = job.solid->first_entry; entry < job.solid->last_entry; entry++) {
      const int facet = entries[entry].y;
      if (!is_lit(&job, facet)) continue;
      corner_t part[CORNERS];
      const int count = facet_in_room(&job, facet, entries[entry].z, entries[entry].w, part);
      if (count < 3) continue;
      if (alone) {
        shade(&job, part, count);
        continue;
      }
      flight_t flight;
      piece_t lit;
      begin_lighting(&job, part, count, &flight);
      while (next_lit(&job, &flight, &lit)) shade(&job, lit.corner, lit.count);
    }
  }
}
