// Rays that wait, one array for each quantity, last in, first out. A packet is taken from the end and what survives goes
// back there: packets stay full however unequal the chains are, and the pool stays small enough for the nearest cache.
#ifndef CULET_POOL
#define CULET_POOL
#include "polarisation.cl"
#include "sky.cl"

// Rays that a pool can hold. Where light can come back to the stone, every packet may leave another one behind in each
// generation, and generations end by weight: some ten for a cut-off of 0.01. What finds no room is counted as cut.
#define POOL_RAYS (REENTRY ? 64 * LANES : 4 * LANES)
#define POOL_SIZE (POOL_RAYS + LANES) // a packet is written whole, and counted as far as it is meant

// A ray's tag: its pixel within the tile, and above that how often it has met the surface from inside.
#define PIXEL_BITS 12
#define PIXEL_MASK ((1 << PIXEL_BITS) - 1)
#define ONE_BOUNCE (1 << PIXEL_BITS)

// A chain has one weight; one that the channels share has one for each, where they are absorbed unequally.
#define WEIGHTS (!SPECTRAL && DISPERSION == 0 && ABSORPTION != 0 ? 3 : 1)
#define POLAR (POLARISED ? 6 : 0) // numbers of a polarisation

typedef struct {
  vec3L origin, direction;
  realL weight[WEIGHTS];
  realL radiance[CHANNELS];
  polarisationL polarisation;
  intL tag;
} packetL;

typedef struct {
  real origin[3][POOL_SIZE], direction[3][POOL_SIZE];
  real weight[WEIGHTS][POOL_SIZE];
  real radiance[CHANNELS][POOL_SIZE];
  real polar[6][POLARISED ? POOL_SIZE : 1];
  int tag[POOL_SIZE];
  int count;
} pool_t;

static inline void store_polarisation(polarisationL p, real polar[6][LANES]) {
  if (!POLARISED) return;
  store_lanes(p.q, polar[0]);
  store_lanes(p.u, polar[1]);
  store_lanes(p.v, polar[2]);
  store_lanes(p.axis.x, polar[3]);
  store_lanes(p.axis.y, polar[4]);
  store_lanes(p.axis.z, polar[5]);
}

// From rows that lie `stride` numbers apart.
static inline polarisationL load_polarisation(const real *rows, int stride) {
  const realL none = splat(0);
  polarisationL p = {none, none, none, {none, none, none}};
  if (!POLARISED) return p;
  p.q = load_lanes(rows);
  p.u = load_lanes(rows + stride);
  p.v = load_lanes(rows + 2 * stride);
  p.axis = vec3(load_lanes(rows + 3 * stride), load_lanes(rows + 4 * stride), load_lanes(rows + 5 * stride));
  return p;
}

// Appends the lanes of a packet that the mask names. Every lane is written and the end moves on over those that stay:
// no branch for the processor to guess wrong.
static inline void push(pool_t *pool, maskL mask, packetL packet) {
  int keep[LANES], tag[LANES];
  real origin[3][LANES], direction[3][LANES], weight[WEIGHTS][LANES], radiance[CHANNELS][LANES], polar[6][LANES];
  store_mask(mask, keep);
  store_polarisation(packet.polarisation, polar);
  store_ints(packet.tag, tag);
  store_lanes(packet.origin.x, origin[0]);
  store_lanes(packet.origin.y, origin[1]);
  store_lanes(packet.origin.z, origin[2]);
  store_lanes(packet.direction.x, direction[0]);
  store_lanes(packet.direction.y, direction[1]);
  store_lanes(packet.direction.z, direction[2]);
  for (int k = 0; k < WEIGHTS; k++) store_lanes(packet.weight[k], weight[k]);
  for (int k = 0; k < CHANNELS; k++) store_lanes(packet.radiance[k], radiance[k]);
  int end = pool->count;
  for (int lane = 0; lane < LANES; lane++) {
    for (int k = 0; k < 3; k++) pool->origin[k][end] = origin[k][lane];
    for (int k = 0; k < 3; k++) pool->direction[k][end] = direction[k][lane];
    for (int k = 0; k < WEIGHTS; k++) pool->weight[k][end] = weight[k][lane];
    for (int k = 0; k < CHANNELS; k++) pool->radiance[k][end] = radiance[k][lane];
    for (int k = 0; k < POLAR; k++) pool->polar[k][end] = polar[k][lane];
    pool->tag[end] = tag[lane];
    end += keep[lane] != 0;
  }
  pool->count = end;
}

// Takes up to a packet from the end; the mask says which lanes hold one. The other lanes hold what was there before,
// which is finite.
static inline packetL pop(pool_t *pool, maskL *mask) {
  const int start = max(pool->count - LANES, 0);
  *mask = widen(LANE_INDEX < (intL)(pool->count - start));
  pool->count = start;
  packetL packet;
  packet.origin = vec3(load_lanes(pool->origin[0] + start), load_lanes(pool->origin[1] + start),
                       load_lanes(pool->origin[2] + start));
  packet.direction = vec3(load_lanes(pool->direction[0] + start), load_lanes(pool->direction[1] + start),
                          load_lanes(pool->direction[2] + start));
  for (int k = 0; k < WEIGHTS; k++) packet.weight[k] = load_lanes(pool->weight[k] + start);
  for (int k = 0; k < CHANNELS; k++) packet.radiance[k] = load_lanes(pool->radiance[k] + start);
  packet.polarisation = load_polarisation(pool->polar[0] + (POLARISED ? start : 0), POOL_SIZE);
  packet.tag = load_ints(pool->tag + start);
  return packet;
}

static inline int has_room(const pool_t *pool) { return pool->count <= POOL_RAYS - LANES; }

static inline void clear(pool_t *pool) {
  pool->count = 0;
  for (int i = 0; i < LANES; i++) { // only here can a packet be taken that is not full
    for (int k = 0; k < 3; k++) pool->origin[k][i] = pool->direction[k][i] = 0;
    for (int k = 0; k < WEIGHTS; k++) pool->weight[k][i] = 0;
    for (int k = 0; k < CHANNELS; k++) pool->radiance[k][i] = 0;
    for (int k = 0; k < POLAR; k++) pool->polar[k][i] = 0;
    pool->tag[i] = 0;
  }
}

#endif
