// What a convex stone makes of light from a dome, as sums over parallel rays: docs/reference/grading.md has the definitions.
//
// A ray goes from the viewer to the stone, and its chain to where its light comes from. What of the chain leaves the stone is
// summed by where it goes; nothing is drawn. All is in the axes of the stone's rows of facets.
#include "facet_rows.cl"
#include "fresnel.cl"

// Of a view, five real4: to the right, up, towards the viewer, of which w is half the width, half the height and the right of
// the middle of what is looked at; the dome's axis with the middle's height; the stone's own axis with the head's cosine.
#define VIEW 5

// What is summed, for each work-item.
#define HITS 0  // rays that meet the stone
#define CROWN 1 // by a facet that looks up
#define ISO 2   // light of a dome of radiance 1, then of cos, then of 2 sin cos of the angle to its axis
#define COS 3
#define SC2 4
#define MIRRORED 5    // light that the surface reflects, wherever from
#define FROM_HEAD 6   // light that comes from the head
#define LEAK 7        // light that comes from under the dome
#define WINDOW 8      // and of that what goes through two facets alone
#define LOST 9        // weight at which chains end
#define ABSORBED 10
#define SQUARES 11    // of each ray's ISO
#define DARK 12       // rays that bring less than DARK_BELOW
#define FIRE 13       // light of two wavelengths that comes from directions further apart than a threshold
#define RETURNED 14   // light of two wavelengths from the dome
#define SPREAD 15     // degrees between the two, times light that both bring by the same facets
#define TOGETHER 16   // that light: what both bring from the dome by the same facets
#define ELEVATIONS 17 // then light without glare, by degrees of elevation above the dome's rim, from -90 on
#define DEGREES 180
#define GRADE_NUMBERS (ELEVATIONS + DEGREES)

#define DARK_BELOW ((real)0.1)

// Kinds of what counts.
#define EVERY_GLARE 1
#define CROWN_GLARE 2 // as of a stone in a closed setting
#define CROWN_ALONE 4 // rays that enter and light that leaves by facets that look up
#define WITH_FIRE 8

// The R2 sequence (M. Roberts, 2018) in 32 bits: exact, however many rays there are.
#define R2_X 3242174889u
#define R2_Y 2447445414u
#define OF_32_BITS ((real)2.3283064365386963e-10)

#define TO_DEGREES ((real)57.29577951308232)

typedef struct {
  vec3L axis, up;
  realL head; // cosine
} domeL;

static inline vec3L uniform3(real4 v) { return vec3(splat(v.x), splat(v.y), splat(v.z)); }

static inline realL only(maskL mask, realL value) { return blend(mask, value, splat(0)); }

static inline double sum_lanes(realL value) {
  real lanes[LANES];
  double sum = 0;
  store_lanes(value, lanes);
  for (int k = 0; k < LANES; k++) sum += lanes[k];
  return sum;
}

// Rows of numbers of rays that wait until they fill a packet: chains have very different lengths, and a packet that went on until
// its longest one has ended would have most of its lanes idle. The latest is taken first, so that few wait.
#define MOST_WAITING (3 * LANES) // a packet may come while all but one of another wait, and is written whole
#define IDLE_LANES 2

// Which lanes of a packet that is taken hold a ray; the rows begin at `count` then.
static inline maskL take_waiting(int *count, real *rows, int numbers) {
  const int taken = min(*count, LANES);
  *count -= taken;
  if (taken < LANES) // no lane holds what was never written
    for (int k = 0; k < numbers; k++)
      for (int lane = taken; lane < LANES; lane++) rows[k * MOST_WAITING + lane] = rows[k * MOST_WAITING];
  return widen(LANE_INDEX < (intL)(taken));
}

// Light that leaves, which waits to be told apart by its elevation.
typedef struct {
  real cosine[MOST_WAITING], light[MOST_WAITING]; // to the dome's axis
  int count;
} leavingL;

// By degrees of elevation: angles to the dome's axis of so many lanes' light.
static inline void note_elevations(double *sums, realL cosine, const real *amount, int count) {
  int degree[LANES];
  const realL elevation = (real)90 - TO_DEGREES * acos(clamp(cosine, (realL)-1, (realL)1));
  store_ints(clamp(reals_to_int(floor_lanes(elevation)) + DEGREES / 2, (intL)0, (intL)(DEGREES - 1)), degree);
  for (int k = 0; k < count; k++) sums[ELEVATIONS + degree[k]] += amount[k];
}

static inline void wait_to_leave(leavingL *leaving, double *sums, realL cosine, realL light, maskL mask) {
  const packing_t packing = packing_of(mask);
  pack_lanes(packing, cosine, leaving->cosine + leaving->count);
  pack_lanes(packing, light, leaving->light + leaving->count);
  leaving->count += packing.count;
  if (leaving->count < LANES) return;
  leaving->count -= LANES;
  note_elevations(sums, load_lanes(leaving->cosine + leaving->count), leaving->light + leaving->count, LANES);
}

// Light that comes from the dome: adds what the lanes bring to each ray's ISO.
static inline void take_from_dome(domeL dome, realL *sums, realL *own, vec3L direction, realL light, maskL mask) {
  const realL cosine = dot3(direction, dome.axis);
  const maskL above = mask & (cosine > 0), seen = above & (cosine <= dome.head);
  const realL brought = only(seen, light);
  *own += brought;
  sums[ISO] += brought;
  sums[COS] += brought * cosine;
  sums[SC2] += brought * cosine * 2 * sqrt(fmax(1 - cosine * cosine, (realL)0));
  sums[FROM_HEAD] += only(above & !seen, light);
}

typedef struct {
  vec3L origin, direction;
  realL weight;
  maskL alive;
} chainsL;

typedef struct {
  vec3L normal, direction; // outward, of light that goes out
  realL light;
  maskL leaves;
} exitL;

// One segment of chains inside, to where some of their light leaves.
static inline exitL follow(chainsL *chains, rows_t rows, chainL eta, realL absorption, realL *absorbed) {
  const crossingL crossing = rows_exit(rows, chains->origin, chains->direction);
  chains->alive &= crossing.hit;
  chains->origin = along(chains->origin, crossing.t, chains->direction);
  const realL passed = chains->weight * exp_fast(-absorption * crossing.t);
  *absorbed += only(chains->alive, chains->weight - passed);
  const realL cos_s = clamp(dot3(chains->direction, crossing.normal), (realL)0, (realL)1);
  const realL squared_a = squared_cosine_in_air(cos_s, eta);
  const realL cos_a = sqrt(fmax(squared_a, (realL)0));
  const maskL through = squared_a > 0;
  const realL kept = blend(through, fresnel_exact(cos_a, cos_s, eta), splat(1));
  const exitL exit = {crossing.normal,
                      normalise(along(scale3((realL)(eta), chains->direction), cos_a - eta * cos_s, crossing.normal)),
                      passed * (1 - kept), through & chains->alive};
  chains->weight = passed * kept;
  chains->direction = renormalise(reflect3(chains->direction, cos_s, crossing.normal));
  return exit;
}

// Light that comes in through a facet.
static inline chainsL refracted(vec3L point, vec3L direction, vec3L normal, realL cos_a, chainL eta, maskL mask) {
  const realL cos_s = cosine_in_stone(cos_a, eta), ratio = splat(1) / eta;
  const chainsL chains = {point, normalise(along(scale3(ratio, direction), ratio * cos_a - cos_s, normal)),
                          1 - fresnel_exact(cos_a, cos_s, eta), mask};
  return chains;
}

// Of one colour, with what of its ray's ISO is known and how many facets it has met.
typedef struct {
  chainsL chains;
  realL own, met;
} followedL;

// Of two wavelengths of one ray: they are together as long as they meet the same facets and none is totally reflected alone.
typedef struct {
  chainsL blue, red;
  realL together, met;
} pairL;

// This list and the next are all that says how waiting rays are kept. A weight of 0 is one of a chain that has ended.
#define CHAIN_NUMBERS 7
#define EACH_OF_CHAIN(of, WITH)                                                                                        \
  WITH((of).origin.x)                                                                                                  \
  WITH((of).origin.y)                                                                                                  \
  WITH((of).origin.z)                                                                                                  \
  WITH((of).direction.x)                                                                                               \
  WITH((of).direction.y)                                                                                               \
  WITH((of).direction.z)                                                                                               \
  WITH((of).weight)

#define FOLLOWED_NUMBERS (CHAIN_NUMBERS + 2)
typedef struct {
  real number[FOLLOWED_NUMBERS][MOST_WAITING];
  int count;
} waiting_chainsL;

static inline void wait_as_chain(waiting_chainsL *waiting, followedL ray, packing_t packing) {
  const int stride = MOST_WAITING;
  real *rows = waiting->number[0] + waiting->count;
  EACH_OF_CHAIN(ray.chains, PACK_NUMBER)
  PACK_NUMBER(ray.own)
  PACK_NUMBER(ray.met)
  waiting->count += packing.count;
}

static inline followedL next_chains(waiting_chainsL *waiting) {
  followedL ray;
  ray.chains.alive = take_waiting(&waiting->count, waiting->number[0], FOLLOWED_NUMBERS);
  const int stride = MOST_WAITING;
  const real *rows = waiting->number[0] + waiting->count;
  EACH_OF_CHAIN(ray.chains, LOAD_NUMBER)
  LOAD_NUMBER(ray.own)
  LOAD_NUMBER(ray.met)
  return ray;
}

#define PAIR_NUMBERS (2 * CHAIN_NUMBERS + 2)
typedef struct {
  real number[PAIR_NUMBERS][MOST_WAITING];
  int count;
} waiting_pairsL;

static inline void wait_as_pair(waiting_pairsL *waiting, pairL ray, packing_t packing) {
  const int stride = MOST_WAITING;
  real *rows = waiting->number[0] + waiting->count;
  ray.blue.weight = only(ray.blue.alive, ray.blue.weight);
  ray.red.weight = only(ray.red.alive, ray.red.weight);
  EACH_OF_CHAIN(ray.blue, PACK_NUMBER)
  EACH_OF_CHAIN(ray.red, PACK_NUMBER)
  PACK_NUMBER(ray.together)
  PACK_NUMBER(ray.met)
  waiting->count += packing.count;
}

static inline pairL next_pairs(waiting_pairsL *waiting) {
  pairL ray;
  const maskL taken = take_waiting(&waiting->count, waiting->number[0], PAIR_NUMBERS);
  const int stride = MOST_WAITING;
  const real *rows = waiting->number[0] + waiting->count;
  EACH_OF_CHAIN(ray.blue, LOAD_NUMBER)
  EACH_OF_CHAIN(ray.red, LOAD_NUMBER)
  LOAD_NUMBER(ray.together)
  LOAD_NUMBER(ray.met)
  ray.blue.alive = taken & (ray.blue.weight > 0);
  ray.red.alive = taken & (ray.red.weight > 0);
  return ray;
}

typedef struct {
  chainL eta, eta_blue, eta_red;
  real absorption, cutoff, threshold;
  int bounces, kind;
} rulesL;

// A packet of chains, until too many of its lanes are idle.
static inline void follow_chains(waiting_chainsL *waiting, leavingL *leaving, domeL dome, rows_t rows, rulesL rules,
                                 realL *sums, double *numbers) {
  followedL ray = next_chains(waiting);
  packing_t packing;
  do {
    const chainsL before = ray.chains;
    const exitL exit = follow(&ray.chains, rows, rules.eta, splat(rules.absorption), &sums[ABSORBED]);
    sums[LOST] += only(before.alive & !ray.chains.alive, before.weight); // rounding put them past an edge
    const realL cosine = dot3(exit.direction, dome.axis);
    maskL leaves = exit.leaves;
    if (rules.kind & CROWN_ALONE) leaves = leaves & (dot3(exit.normal, dome.up) > (real)1e-6);
    take_from_dome(dome, sums, &ray.own, exit.direction, exit.light, leaves);
    const realL under = only(leaves & (cosine <= 0), exit.light);
    sums[LEAK] += under;
    sums[WINDOW] += only(ray.met == 0, under);
    wait_to_leave(leaving, numbers, cosine, exit.light, leaves);
    ray.met += 1;
    const maskL ends_here = ray.chains.alive & ((ray.chains.weight < rules.cutoff) | (ray.met >= (real)rules.bounces));
    sums[LOST] += only(ends_here, ray.chains.weight);
    ray.chains.alive &= !ends_here;
    const maskL ended = before.alive & !ray.chains.alive;
    sums[SQUARES] += only(ended, ray.own * ray.own);
    sums[DARK] += only(ended & (ray.own < DARK_BELOW), splat(1));
    packing = packing_of(ray.chains.alive);
  } while (packing.count > 0 && packing.count >= LANES - IDLE_LANES);
  wait_as_chain(waiting, ray, packing);
}

// The same of light of two wavelengths, half of each. They part where they meet different facets, or one is totally reflected.
static inline void follow_pairs(waiting_pairsL *waiting, domeL dome, rows_t rows, rulesL rules, realL *sums) {
  pairL ray = next_pairs(waiting);
  packing_t packing;
  realL absorbed = splat(0);
  do {
    const exitL b = follow(&ray.blue, rows, rules.eta_blue, splat(0), &absorbed);
    const exitL r = follow(&ray.red, rows, rules.eta_red, splat(0), &absorbed);
    const vec3L between = along(b.normal, splat(-1), r.normal);
    const maskL together = (ray.together > 0) & (dot3(between, between) < (real)1e-6);
    const vec3L apart = along(b.direction, splat(-1), r.direction);
    const realL chord = sqrt(dot3(apart, apart));
    const realL degrees = 2 * TO_DEGREES * asin(fmin((real)0.5 * chord, (realL)1));
    const realL cosine_b = dot3(b.direction, dome.axis), cosine_r = dot3(r.direction, dome.axis);
    const realL of_blue = only(b.leaves & (cosine_b > 0) & (cosine_b <= dome.head), (real)0.5 * b.light);
    const realL of_red = only(r.leaves & (cosine_r > 0) & (cosine_r <= dome.head), (real)0.5 * r.light);
    const maskL both = together & b.leaves & r.leaves;
    sums[RETURNED] += of_blue + of_red;
    sums[FIRE] += only(!(both & (degrees <= rules.threshold)), of_blue + of_red);
    sums[SPREAD] += only(both, degrees * (of_blue + of_red));
    sums[TOGETHER] += only(both, of_blue + of_red);
    ray.together = only(together, splat(1));
    ray.met += 1;
    const maskL goes_on = ray.met < (real)rules.bounces;
    ray.blue.alive &= goes_on & (ray.blue.weight >= rules.cutoff);
    ray.red.alive &= goes_on & (ray.red.weight >= rules.cutoff);
    packing = packing_of(ray.blue.alive | ray.red.alive);
  } while (packing.count > 0 && packing.count >= LANES - IDLE_LANES);
  wait_as_pair(waiting, ray, packing);
}

// A work-item sees to `packets` packets of rays of one view; `shifts` are its sequence's, two of 32 bits. The sums of each
// work-item are GRADE_NUMBERS.
__kernel void grade(__global const real4 *facets, int count, __global const real4 *row_table,
                    __constant const int *ends, __global const real4 *views, int items_of_view,
                    __global const uint *shifts, int packets, real eta, real eta_blue, real eta_red, real absorption,
                    real cutoff, int bounces, real threshold, int kind, __global double *result) {
  const int item = get_global_id(0);
  __global const real4 *view = views + VIEW * (item / items_of_view);
  const real4 right = view[0], up = view[1], toward = view[2];
  const rows_t rows = rows_of(row_table, ends);
  const domeL dome = {uniform3(view[3]), uniform3(view[4]), splat(view[4].w)};
  const vec3L direction = scale3(splat(-1), uniform3(toward));
  const rulesL rules = {(chainL)(eta), (chainL)(eta_blue), (chainL)(eta_red), absorption,
                        cutoff,        threshold,          bounces,           kind};
  realL sums[ELEVATIONS];
  double numbers[GRADE_NUMBERS]; // all of a plate's light is of one elevation, which single precision could not add up
  waiting_chainsL chains;
  waiting_pairsL pairs;
  leavingL leaving;
  chains.count = pairs.count = leaving.count = 0;
  EACH (k, ELEVATIONS) sums[k] = splat(0);
  for (int k = 0; k < GRADE_NUMBERS; k++) numbers[k] = 0;
  for (int packet = 0; packet < packets || chains.count > 0 || pairs.count > 0;) {
    const int least = packet < packets ? LANES : 1; // that are worth to be followed
    if (chains.count >= least) {
      follow_chains(&chains, &leaving, dome, rows, rules, sums, numbers);
      continue;
    }
    if (pairs.count >= least) {
      follow_pairs(&pairs, dome, rows, rules, sums);
      continue;
    }
    real across[LANES], high[LANES];
    for (int k = 0; k < LANES; k++) {
      const uint ray = packet * LANES + k;
      across[k] = OF_32_BITS * (real)(shifts[2 * item] + ray * R2_X);
      high[k] = OF_32_BITS * (real)(shifts[2 * item + 1] + ray * R2_Y);
    }
    packet++;
    const realL x = toward.w + right.w * (2 * load_lanes(across) - 1);
    const realL y = view[3].w + up.w * (2 * load_lanes(high) - 1);
    const vec3L origin = along(along(scale3(splat(2), uniform3(toward)), x, uniform3(right)), y, uniform3(up));
    const crossingL entry = hull_entry(facets, count, origin, direction, splat(0));
    const maskL crown = entry.hit & (dot3(entry.normal, dome.up) > (real)1e-6);
    const maskL counted = kind & CROWN_ALONE ? crown : entry.hit;
    sums[HITS] += only(entry.hit, splat(1));
    sums[CROWN] += only(crown, splat(1));
    if (!any_lane(counted)) continue;

    const vec3L point = along(origin, entry.t, direction);
    const realL cos_a = clamp(-dot3(direction, entry.normal), (realL)0, (realL)1);
    const packing_t packing = packing_of(counted);
    followedL ray = {refracted(point, direction, entry.normal, cos_a, rules.eta, counted), splat(0), splat(0)};
    const realL mirrored = 1 - ray.chains.weight;
    sums[MIRRORED] += only(counted, mirrored);
    if (kind & (EVERY_GLARE | CROWN_GLARE))
      take_from_dome(dome, sums, &ray.own, reflect3(direction, -cos_a, entry.normal), mirrored,
                     kind & EVERY_GLARE ? counted : counted & crown);
    wait_as_chain(&chains, ray, packing);
    if (kind & WITH_FIRE) {
      const pairL pair = {refracted(point, direction, entry.normal, cos_a, rules.eta_blue, counted),
                          refracted(point, direction, entry.normal, cos_a, rules.eta_red, counted), splat(1), splat(0)};
      wait_as_pair(&pairs, pair, packing);
    }
  }
  const int left = leaving.count;
  if (left > 0) {
    for (int lane = left; lane < LANES; lane++) leaving.cosine[lane] = leaving.cosine[0];
    note_elevations(numbers, load_lanes(leaving.cosine), leaving.light, left);
  }
  EACH (k, ELEVATIONS) numbers[k] = sum_lanes(sums[k]);
  for (int k = 0; k < GRADE_NUMBERS; k++) result[item * GRADE_NUMBERS + k] = numbers[k];
}
