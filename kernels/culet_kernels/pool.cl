// Rays that wait, one row for each quantity, last in, first out. A packet is taken from the end and what survives goes
// back there: packets stay full however unequal the chains are, and the pool stays small enough for the nearest cache.
#ifndef CULET_POOL
#define CULET_POOL
#include "packet.cl"

// Rays that a pool can hold. Where light can come back to the stone, every packet may leave another one behind in each
// generation, and generations end by weight: some ten for a cut-off of 0.01. What finds no room is counted as cut.
#define POOL_RAYS (REENTRY ? 64 * LANES : 4 * LANES)
#define POOL_SIZE (POOL_RAYS + LANES) // a packet is written whole, and counted as far as it is meant

typedef struct {
  real number[NUMBERS][POOL_SIZE];
  int whole[WHOLES][POOL_SIZE];
  int count;
} pool_t;

// Appends the lanes of a packet that the mask names.
static inline void push(pool_t *pool, maskL mask, const packetL *packet) {
  const packing_t packing = packing_of(mask);
  pack_packet(packing, packet, pool->number[0] + pool->count, pool->whole[0] + pool->count, POOL_SIZE);
  pool->count += packing.count;
}

// Takes up to a packet from the end; the mask says which lanes hold one. The other lanes hold what was there before,
// which is finite.
__attribute__((always_inline)) static inline packetL pop(pool_t *pool, maskL *mask) {
  const int start = max(pool->count - LANES, 0);
  *mask = widen(LANE_INDEX < (intL)(pool->count - start));
  pool->count = start;
  return load_packet(pool->number[0] + start, pool->whole[0] + start, POOL_SIZE);
}

static inline int has_room(const pool_t *pool) { return pool->count <= POOL_RAYS - LANES; }

static inline void clear(pool_t *pool) {
  pool->count = 0;
  for (int i = 0; i < LANES; i++) { // only here can a packet be taken that is not full
    EACH (k, NUMBERS) pool->number[k][i] = 0;
    EACH (k, WHOLES) pool->whole[k][i] = 0;
  }
}

#endif
