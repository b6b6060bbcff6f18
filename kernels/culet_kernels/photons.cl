// Photons: light of the room's emitters that meets stones, followed through all of them to where it lands, as points with a
// weight. What would have landed without the stones is taken away in the same way, so that a map of them adds to the
// unshaded light; a stone of index 1 changes nothing, to the last photon.
//
// H. W. Jensen, Realistic Image Synthesis Using Photon Mapping (2001); the photons of a pass lie by a low-discrepancy
// sequence over the stones as each emitter sees them.
#include "inside.cl"

// A landing: surface, u, v, and its weight by channel; then what kind it is.
#define LANDING_NUMBERS 6
#define SURFACE_OF 0
#define U_OF 1
#define V_OF 2
#define WEIGHT_OF 3

// What a work-item counts: landings, and flux, as the mean of the channels.
#define LANDINGS 0
#define INCIDENT 1
#define CUT_FLUX 2
#define OUTSIDE 3   // on a matte surface, beyond its map
#define ELSEWHERE 4 // to the sky, to a mirror, or into a surface that a stone reaches through
#define OVERFLOWN 5 // no room for the landing
#define LANDED 6    // on the map
#define SEGMENTS_MADE 7
#define COUNTS 8

// Photons that are under way together.
#define BATCH TILE_PIXELS
// Of the ray's number that it has before its light: farther than all stones are apart.
#define FAR_BACK ((real) - 1e6)

typedef struct {
  tile_t tile; // of which a photon's place is a pixel, whose cut weight is counted
  pools_t pools;
  int bundle[BATCH];
  spectrum_t spectrum;
} photons_t;

typedef struct {
  __global float *landings;
  int capacity;
  double *counts;
} landings_t;

// Where lanes of light land, by the surface that they meet first. `sign` is -1 for what the stone takes away. Returns the flux.
static inline double land(world_t world, __constant const map_frame_t *frame, __global const bundle_t *bundles,
                          const photons_t *photons, task_t task, const packetL *packet, vec3L origin, vec3L direction,
                          maskL mask, real sign, landings_t *to) {
  __constant const parameters_t *scene = world.scene;
  realL nearest = splat(1e30f), surface = splat(-1);
  maskL buried = mask & !mask;
  for (int i = 0; i < MAX_SURFACES; i++) {
    const int kind = i == 0 ? DECIDED(FLOOR, scene->floor_kind) : DECIDED(WALLS, scene->walls_kind);
    if (kind == NONE) continue;
    const real4 plane = (real4)(scene->surface[i][0], scene->surface[i][1], scene->surface[i][2], scene->surface[i][3]);
    const realL speed = dot_uniform(direction, plane), gap = dot_uniform(origin, plane) - plane.w;
    const realL t = fmax(gap, splat(0)) / fmax(-speed, splat(HORIZON));
    const maskL nearer = (speed < -HORIZON) & (t < nearest);
    buried |= gap < -SLOP;
    nearest = blend(nearer, t, nearest);
    surface = blend(nearer, splat(kind == MATTE ? (real)i : (real)-1), surface);
  }
  const vec3L point = along(origin, blend(nearest < (real)1e29, nearest, splat(0)), direction);
  real place[3][LANES], weight[WEIGHTS][LANES], on[LANES];
  int lanes[LANES], tag[LANES];
  double sum = 0;
  store_mask(mask, lanes);
  store_ints(packet->tag, tag);
  store_lanes(blend(buried, splat(-1), surface), on);
  store_lanes(point.x, place[0]);
  store_lanes(point.y, place[1]);
  store_lanes(point.z, place[2]);
  EACH (k, WEIGHTS) store_lanes(packet->weight[k], weight[k]);
  for (int lane = 0; lane < LANES; lane++) {
    if (!lanes[lane]) continue;
    __global const bundle_t *bundle = bundles + photons->bundle[tag[lane] & PIXEL_MASK];
    float light[3] = {0, 0, 0};
    double flux = 0;
    EACH (k, CHANNELS) {
      const int channel = task.first_channel + k;
      real share = weight[min(k, WEIGHTS - 1)][lane];
      if (SPECTRAL) share *= task.chains[tag[lane] >> PIXEL_BITS & (GROUPS - 1)].share[channel];
      light[channel] = sign * share * bundle->flux[channel];
      flux += light[channel];
    }
    flux /= 3;
    sum += flux;
    const int number = (int)on[lane];
    if (number < 0) {
      to->counts[ELSEWHERE] += flux;
      continue;
    }
    const real x = place[0][lane], y = place[1][lane], z = place[2][lane];
    const real u = x * frame->along[number][0] + y * frame->along[number][1] + z * frame->along[number][2] -
                   frame->centre[number][0];
    const real v = x * frame->across[number][0] + y * frame->across[number][1] + z * frame->across[number][2] -
                   frame->centre[number][1];
    if (number >= frame->held || fmax(fabs(u), fabs(v)) >= frame->half_size[1]) {
      to->counts[OUTSIDE] += flux;
      continue;
    }
    const int count = (int)to->counts[LANDINGS];
    if (count >= to->capacity) {
      to->counts[OVERFLOWN] += fabs(flux);
      continue;
    }
    real growth = 1;
    if (bundle->distance > 0) {
      const real dx = x - bundle->centre[0] + bundle->distance * bundle->axis[0],
                 dy = y - bundle->centre[1] + bundle->distance * bundle->axis[1],
                 dz = z - bundle->centre[2] + bundle->distance * bundle->axis[2];
      growth = (dx * dx + dy * dy + dz * dz) * bundle->growth;
    }
    __global float *landing = to->landings + (size_t)count * LANDING_NUMBERS;
    landing[SURFACE_OF] = number;
    landing[U_OF] = u;
    landing[V_OF] = v;
    EACH (k, 3) landing[WEIGHT_OF + k] = light[k] * growth;
    to->counts[LANDINGS] = count + 1;
    to->counts[LANDED] += flux;
  }
  return sum;
}

// Sets up LANES photons, the first of which has this number in its bundle and its chain. Gives their rays, abreast of the
// stone.
static inline rayL emitted(__global const bundle_t *bundle, uint number, int step) {
  real rows[7][LANES];
  for (int lane = 0; lane < LANES; lane++) {
    const uint n = number + lane;
    // R2 (M. Roberts, 2018), in whole numbers, which are exact modulo 1
    const real a = (real)(n * 3242174889u >> 8) * (real)(1.0f / (1 << 24)) + bundle->shift[0] + step * (real)0.618034,
               b = (real)(n * 2447445414u >> 8) * (real)(1.0f / (1 << 24)) + bundle->shift[1] + step * (real)0.381966;
    // From a square to a circle, which keeps neighbours (P. Shirley and K. Chiu, A Low Distortion Map Between Disk and
    // Square, 1997): in polar coordinates they would crowd at its middle.
    const real x = 2 * (a - floor(a)) - 1, y = 2 * (b - floor(b)) - 1;
    const int steep = fabs(y) > fabs(x);
    const real far = steep ? y : x, near = steep ? x : y, part = far * far;
    const real eighth = (real)0.78539816f * near / (fabs(far) > 0 ? far : 1);
    const real turn = steep ? (real)1.57079633f - eighth : eighth;
    real ahead = 1, aside = 0, back = 0, off, start = FAR_BACK;
    if (bundle->distance > 0) {
      const real short_of = part * bundle->spread;
      ahead = 1 - short_of;
      aside = copysign(sqrt(short_of * (2 - short_of)), far);
      back = -bundle->distance * aside * aside;
      off = bundle->distance * aside * ahead;
      start = -bundle->distance * ahead;
    } else {
      off = bundle->radius * far;
    }
    const real sine = sin(turn), cosine = cos(turn);
    EACH (k, 3) {
      const real out = cosine * bundle->across[0][k] + sine * bundle->across[1][k];
      rows[k][lane] = bundle->centre[k] + back * bundle->axis[k] + off * out;
      rows[3 + k][lane] = ahead * bundle->axis[k] + aside * out;
    }
    rows[6][lane] = start;
  }
  rayL ray;
  ray.origin = vec3(load_lanes(rows[0]), load_lanes(rows[1]), load_lanes(rows[2]));
  ray.direction = renormalise(vec3(load_lanes(rows[3]), load_lanes(rows[4]), load_lanes(rows[5])));
  ray.start = load_lanes(rows[6]);
  ray.weight = splat(1);
  ray.polarisation = unpolarised(ray.direction);
  return ray;
}

// Follows what waits, to its end.
static inline void follow(world_t world, __constant const map_frame_t *frame, __global const bundle_t *bundles,
                          photons_t *photons, task_t task, landings_t *to, bool last) {
  pools_t *pools = &photons->pools;
  for (;;) {
    pool_t *left = larger_away(pools);
    if (left->count >= LANES || (last && is_dark_inside(pools) && is_clear(pools) && left->count > 0)) {
      maskL taken;
      const packetL packet = pop(left, &taken);
      land(world, frame, bundles, photons, task, &packet, packet.origin, packet.direction, taken, 1, to);
    } else if (look_outside(world, &photons->tile, pools, task, last && is_dark_inside(pools)))
      continue;
    else if (has_full(&pools->inside) || (last && !is_dark_inside(pools)))
      advance(world, &photons->tile, pools, task, last && !has_full(&pools->inside));
    else
      return;
  }
}

// Shoots BATCH photons for each of the jobs from `first` to before `last`, of which each work-item takes its share. A job is of
// one bundle and one chain, or group of chains; `begun` is how many photons of each bundle and chain were shot before.
__kernel void shoot(WORLD_BUFFERS(AS_ARGUMENT) __constant const map_frame_t *frame, __global const bundle_t *bundles,
                    int bundle_count, int first, int last, int follow_on, __global float *landings, int capacity,
                    __global double *counts) {
  const world_t world = {WORLD_BUFFERS(AS_VALUE)};
  const int item = get_global_id(0);
  double own[COUNTS];
  for (int i = 0; i < COUNTS; i++) own[i] = 0;
  landings_t to = {landings + (size_t)item * capacity * LANDING_NUMBERS, capacity, own};
  photons_t photons;
  const int steps = (scene->chains + GROUPS - 1) / GROUPS;
  for (int job = first + item; job < last; job += get_global_size(0)) {
    const int number = job / steps % bundle_count, round = job / steps / bundle_count, chain = job % steps * GROUPS;
    __global const bundle_t *bundle = bundles + number;
    const task_t task = task_of(world, 0, chain, job, &photons.spectrum);
    clear_pools(&photons.pools);
    photons.tile.segments = (intL)(0);
    const real flux = CHANNELS == 3 ? (bundle->flux[0] + bundle->flux[1] + bundle->flux[2]) / 3
                                    : bundle->flux[task.first_channel] / 3;
    for (int i = 0; i < BATCH; i++) {
      photons.tile.cut[i] = 0;
      photons.bundle[i] = number;
    }
    for (int i = 0; i < BATCH; i += LANES) {
      const rayL ray = emitted(bundle, (uint)round * BATCH + i, job % steps);
      const maskL all = widen(LANE_INDEX >= (intL)(0));
      meetingL met = stone_entry(world, ray.origin, ray.direction, ray.start, all, (intL)(NOBODY));
      const maskL meets = met.hit & widen(met.stone == (intL)(bundle->stone)) & !hidden_by_room(world, ray, met.t);
      if (!any_lane(meets)) continue;
      packetL packet;
      packet.direction = ray.direction;
      EACH (k, WEIGHTS) packet.weight[k] = splat(1);
      packet.polarisation = ray.polarisation;
      packet.tag = i + LANE_INDEX + ((LANE_INDEX + i / LANES) % GROUPS << PIXEL_BITS);
      met.stone = packet.stone = blend_ints_by(meets, met.stone, (intL)(0));
      bring(world, &packet, met);
      const vec3L point = along(ray.origin, blend(meets, met.t, splat(0)), ray.direction);
      own[INCIDENT] -= land(world, frame, bundles, &photons, task, &packet, point, ray.direction, meets, -1, &to);
      if (!follow_on) continue;
      enter(world, &photons.tile, &photons.pools, task, &packet, point, met.normal, meets, true);
      follow(world, frame, bundles, &photons, task, &to, false);
    }
    follow(world, frame, bundles, &photons, task, &to, true);
    double cut = 0;
    for (int i = 0; i < BATCH; i++) cut += photons.tile.cut[i];
    own[CUT_FLUX] += cut / CHANNELS * flux;
    int segments[LANES];
    store_ints(photons.tile.segments, segments);
    for (int lane = 0; lane < LANES; lane++) own[SEGMENTS_MADE] += segments[lane];
  }
  for (int i = 0; i < COUNTS; i++) counts[item * COUNTS + i] = own[i];
}

// The fineness of the grid in which landings are counted: cells on each side of a level.
#define CELLS 64

// The cell, or texel, of a level in which a landing is; not a place of that level if it is beyond its edge.
static inline int cell_at(__constant const map_frame_t *frame, int level, real place, int size) {
  return (int)floor((place / frame->half_size[level] + 1) * (real)0.5 * size);
}

// Counts landings by kind (what stones take away first), surface, level and cell; a work-item for each kind.
__kernel void count(__constant const map_frame_t *frame, __global const float *landings, int capacity,
                    __global const double *counts, int parts, __global int *cells) {
  const int kind = get_global_id(0);
  __global int *own = cells + kind * frame->held * MAP_LEVELS * CELLS * CELLS;
  for (int part = 0; part < parts; part++) {
    __global const float *landing = landings + (size_t)part * capacity * LANDING_NUMBERS;
    const int last = (int)counts[part * COUNTS + LANDINGS];
    for (int i = 0; i < last; i++, landing += LANDING_NUMBERS) {
      const float sum = landing[WEIGHT_OF] + landing[WEIGHT_OF + 1] + landing[WEIGHT_OF + 2];
      if ((sum < 0) != (kind == 0)) continue;
      for (int level = 0; level < MAP_LEVELS; level++) {
        const int column = cell_at(frame, level, landing[U_OF], CELLS),
                  row = cell_at(frame, level, landing[V_OF], CELLS);
        if (min(column, row) >= 0 && max(column, row) < CELLS)
          own[(((int)landing[SURFACE_OF] * MAP_LEVELS + level) * CELLS + row) * CELLS + column]++;
      }
    }
  }
}

// A quantity of cells, linearly between their middles.
static inline float between(__global const float *cells, float column, float row) {
  const float x = clamp(column, 0.0f, CELLS - 1.0f), y = clamp(row, 0.0f, CELLS - 1.0f);
  const int i = min((int)x, CELLS - 2), j = min((int)y, CELLS - 2);
  __global const float *first = cells + j * CELLS + i;
  return mix(mix(first[0], first[1], x - i), mix(first[CELLS], first[CELLS + 1], x - i), y - j);
}

// Spreads landings over the map, each as a paraboloid (Epanechnikov) about its place whose radius, in texels, `radii` has by
// the cells of `count`. Its texels share its whole weight, so that nothing is lost but what is spread beyond the edge. A
// work-item has its own rows of each level.
__kernel void spread(__constant const map_frame_t *frame, __global const float *landings, int capacity,
                     __global const double *counts, int parts, __global const float *radii, __global float *map) {
  const int items = get_global_size(0), item = get_global_id(0);
  const int first_row = item * MAP_SIZE / items, end_row = (item + 1) * MAP_SIZE / items;
  for (int part = 0; part < parts; part++) {
    __global const float *landing = landings + (size_t)part * capacity * LANDING_NUMBERS;
    const int last = (int)counts[part * COUNTS + LANDINGS];
    for (int i = 0; i < last; i++, landing += LANDING_NUMBERS) {
      const float light[3] = {landing[WEIGHT_OF], landing[WEIGHT_OF + 1], landing[WEIGHT_OF + 2]};
      const int kind = light[0] + light[1] + light[2] < 0 ? 0 : 1, surface = (int)landing[SURFACE_OF];
      for (int level = 0; level < MAP_LEVELS; level++) {
        const float scale = MAP_SIZE / (2 * frame->half_size[level]);
        const float u = landing[U_OF] * scale + (MAP_SIZE / 2 - 0.5f),
                    v = landing[V_OF] * scale + (MAP_SIZE / 2 - 0.5f);
        const float radius = between(radii + ((kind * frame->held + surface) * MAP_LEVELS + level) * CELLS * CELLS,
                                     (u + 0.5f) * CELLS / MAP_SIZE - 0.5f, (v + 0.5f) * CELLS / MAP_SIZE - 0.5f);
        const int left = (int)ceil(u - radius), right = (int)floor(u + radius), top = (int)ceil(v - radius),
                  bottom = (int)floor(v + radius);
        if (right < 0 || left >= MAP_SIZE || bottom < first_row || top >= end_row) continue;
        const float inverse = 1 / (radius * radius);
        float sum = 0;
        for (int y = top; y <= bottom; y++) {
          const float rest = 1 - (y - v) * (y - v) * inverse;
          for (int x = left; x <= right; x++) sum += fmax(rest - (x - u) * (x - u) * inverse, 0.0f);
        }
        const float share = scale * scale / fmax(sum, 1e-20f);
        for (int y = max(top, first_row); y <= min(bottom, end_row - 1); y++) {
          const float rest = 1 - (y - v) * (y - v) * inverse;
          __global float *texels = map + ((size_t)(surface * MAP_LEVELS + level) * MAP_SIZE + y) * MAP_SIZE * 3;
          for (int x = max(left, 0); x <= min(right, MAP_SIZE - 1); x++) {
            const float weight = share * fmax(rest - (x - u) * (x - u) * inverse, 0.0f);
            EACH (k, 3) texels[3 * x + k] = fma(weight, light[k], texels[3 * x + k]);
          }
        }
      }
    }
  }
}

// The mean of passes: the map becomes `keep` times what it was, plus `gain` times what was made.
__kernel void join(__global float *map, __global const float *made, int count, float keep, float gain) {
  const int items = get_global_size(0), item = get_global_id(0);
  const int first = (int)((long)count * item / items), end = (int)((long)count * (item + 1) / items);
  for (int i = first; i < end; i++) map[i] = keep > 0 ? fma(keep, map[i], gain * made[i]) : gain * made[i];
}
