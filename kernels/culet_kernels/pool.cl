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

// A ray's tag: its pixel within the tile, above that the group that the pixel belongs to, and above that how often the ray
// has met the surface from inside.
#define PIXEL_BITS 12
#define GROUP_BITS 2
#define PIXEL_MASK ((1 << PIXEL_BITS) - 1)
#define BOUNCE_SHIFT (PIXEL_BITS + GROUP_BITS)
#define ONE_BOUNCE (1 << BOUNCE_SHIFT)

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

// To rows that lie `stride` numbers apart.
static inline void pack_polarisation(packing_t packing, polarisationL p, real *rows, int stride) {
  pack_lanes(packing, p.q, rows);
  pack_lanes(packing, p.u, rows + stride);
  pack_lanes(packing, p.v, rows + 2 * stride);
  pack_lanes(packing, p.axis.x, rows + 3 * stride);
  pack_lanes(packing, p.axis.y, rows + 4 * stride);
  pack_lanes(packing, p.axis.z, rows + 5 * stride);
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

// Appends the lanes of a packet that the mask names.
static inline void push(pool_t *pool, maskL mask, const packetL *packet) {
  const packing_t packing = packing_of(mask);
  const int end = pool->count;
  pack_lanes(packing, packet->origin.x, pool->origin[0] + end);
  pack_lanes(packing, packet->origin.y, pool->origin[1] + end);
  pack_lanes(packing, packet->origin.z, pool->origin[2] + end);
  pack_lanes(packing, packet->direction.x, pool->direction[0] + end);
  pack_lanes(packing, packet->direction.y, pool->direction[1] + end);
  pack_lanes(packing, packet->direction.z, pool->direction[2] + end);
  EACH (k, WEIGHTS) pack_lanes(packing, packet->weight[k], pool->weight[k] + end);
  EACH (k, CHANNELS) pack_lanes(packing, packet->radiance[k], pool->radiance[k] + end);
  if (POLARISED) pack_polarisation(packing, packet->polarisation, pool->polar[0] + end, POOL_SIZE);
  pack_ints(packing, packet->tag, pool->tag + end);
  pool->count = end + packing.count;
}

// Takes up to a packet from the end; the mask says which lanes hold one. The other lanes hold what was there before,
// which is finite.
__attribute__((always_inline)) static inline packetL pop(pool_t *pool, maskL *mask) {
  const int start = max(pool->count - LANES, 0);
  *mask = widen(LANE_INDEX < (intL)(pool->count - start));
  pool->count = start;
  packetL packet;
  packet.origin = vec3(load_lanes(pool->origin[0] + start), load_lanes(pool->origin[1] + start),
                       load_lanes(pool->origin[2] + start));
  packet.direction = vec3(load_lanes(pool->direction[0] + start), load_lanes(pool->direction[1] + start),
                          load_lanes(pool->direction[2] + start));
  EACH (k, WEIGHTS) packet.weight[k] = load_lanes(pool->weight[k] + start);
  EACH (k, CHANNELS) packet.radiance[k] = load_lanes(pool->radiance[k] + start);
  packet.polarisation = load_polarisation(pool->polar[0] + (POLARISED ? start : 0), POOL_SIZE);
  packet.tag = load_ints(pool->tag + start);
  return packet;
}

static inline int has_room(const pool_t *pool) { return pool->count <= POOL_RAYS - LANES; }

static inline void clear(pool_t *pool) {
  pool->count = 0;
  for (int i = 0; i < LANES; i++) { // only here can a packet be taken that is not full
    EACH (k, 3) pool->origin[k][i] = pool->direction[k][i] = 0;
    EACH (k, WEIGHTS) pool->weight[k][i] = 0;
    EACH (k, CHANNELS) pool->radiance[k][i] = 0;
    EACH (k, POLAR) pool->polar[k][i] = 0;
    pool->tag[i] = 0;
  }
}

#endif
