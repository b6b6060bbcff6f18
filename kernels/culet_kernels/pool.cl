// Rays that wait, one row for each quantity, last in, first out. A packet is taken from the end and what survives goes
// back there: packets stay full however unequal the chains are, and the pool stays small enough for the nearest cache.
#ifndef CULET_POOL
#define CULET_POOL
#include "packet.cl"
#include "stones.cl"

// Rays that a pool can hold. Where light can come back to a stone, every packet may leave another one behind in each
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

// A packet that comes into a stone, or begins there.
static inline packetL turned_inward(__constant const stone_t *stone, const packetL *packet) {
  packetL inner = *packet;
  inner.origin = inward(stone, packet->origin);
  inner.direction = inward(stone, packet->direction);
  if (POLARISED) inner.polarisation.axis = inward(stone, packet->polarisation.axis);
  return inner;
}

// Rays inside stones, in the axes of light inside. A packet of them is in one stone, since its facets are looked at by all lanes together: the rays of each
// stone gather until they are a packet, and full packets wait in a pile, the latest on top.
#if STONES == MANY
#define PILE 256 // full packets that may wait; what finds no room is counted as cut

typedef struct {
  real number[NUMBERS][2 * LANES];
  int whole[WHOLES][2 * LANES];
  int count;
} gathering_t;

typedef struct {
  real number[PILE][NUMBERS][LANES];
  int whole[PILE][WHOLES][LANES];
  int stone[PILE];
  gathering_t of_stone[MAX_STONES];
  int full;      // packets on the pile
  int gathering; // rays of all stones that are not yet a packet
} inside_t;

static inline void clear_inside(inside_t *inside) {
  inside->full = inside->gathering = 0;
  for (int i = 0; i < MAX_STONES; i++) inside->of_stone[i].count = 0;
}

static inline int is_empty(const inside_t *inside) { return inside->full == 0 && inside->gathering == 0; }

static inline int has_full(const inside_t *inside) { return inside->full > 0; }

// Whether a packet has room, whatever stones its lanes are in.
static inline int has_room_inside(const inside_t *inside) { return inside->full <= PILE - LANES; }

static inline void push_to_stone(inside_t *inside, int stone, maskL mask, const packetL *packet) {
  gathering_t *own = inside->of_stone + stone;
  const packing_t packing = packing_of(mask);
  pack_packet(packing, packet, own->number[0] + own->count, own->whole[0] + own->count, 2 * LANES);
  own->count += packing.count;
  inside->gathering += packing.count;
  if (own->count < LANES) return;
  own->count -= LANES;
  inside->gathering -= LANES;
  EACH (k, NUMBERS) store_lanes(load_lanes(own->number[k] + own->count), inside->number[inside->full][k]);
  EACH (k, WHOLES) store_ints(load_ints(own->whole[k] + own->count), inside->whole[inside->full][k]);
  inside->stone[inside->full++] = stone;
}

// Appends the lanes that the mask names, each to its own stone, of a packet that comes from outside.
static inline void push_inside(world_t world, inside_t *inside, maskL mask, const packetL *packet) {
  int named[LANES], number[LANES];
  store_mask(mask, named);
  store_ints(packet->stone, number);
  for (int lane = 0; lane < LANES; lane++) {
    if (!named[lane]) continue;
    const int stone = number[lane];
    const maskL same = mask & widen(packet->stone == (intL)(stone));
    const packetL inner = turned_inward(world.stones + stone, packet);
    push_to_stone(inside, stone, same, &inner);
    for (int other = lane + 1; other < LANES; other++) named[other] = number[other] == stone ? 0 : named[other];
  }
}

// Takes a packet of one stone: the one on top of the pile; if that is empty, the largest that gathers.
__attribute__((always_inline)) static inline packetL pop_inside(inside_t *inside, maskL *mask, int *stone) {
  const maskL all = widen(LANE_INDEX < (intL)(LANES));
  if (inside->full > 0) {
    inside->full--;
    *mask = all;
    *stone = inside->stone[inside->full];
    return load_packet(inside->number[inside->full][0], inside->whole[inside->full][0], LANES);
  }
  int largest = 0;
  for (int i = 1; i < MAX_STONES; i++)
    if (inside->of_stone[i].count > inside->of_stone[largest].count) largest = i;
  gathering_t *own = inside->of_stone + largest;
  EACH (k, NUMBERS) // no lane holds what was never written
    for (int lane = own->count; lane < LANES; lane++) own->number[k][lane] = own->number[k][0];
  EACH (k, WHOLES)
    for (int lane = own->count; lane < LANES; lane++) own->whole[k][lane] = own->whole[k][0];
  *mask = widen(LANE_INDEX < (intL)(own->count));
  *stone = largest;
  inside->gathering -= own->count;
  own->count = 0;
  return load_packet(own->number[0], own->whole[0], 2 * LANES);
}
#else
typedef pool_t inside_t;
static inline void clear_inside(inside_t *inside) { clear(inside); }
static inline int is_empty(const inside_t *inside) { return inside->count == 0; }
static inline int has_full(const inside_t *inside) { return inside->count >= LANES; }
static inline int has_room_inside(const inside_t *inside) { return has_room(inside); }
static inline void push_to_stone(inside_t *inside, int stone, maskL mask, const packetL *packet) {
  push(inside, mask, packet);
}
static inline void push_inside(world_t world, inside_t *inside, maskL mask, const packetL *packet) {
  const packetL inner = turned_inward(world.stones, packet);
  push(inside, mask, &inner);
}
__attribute__((always_inline)) static inline packetL pop_inside(inside_t *inside, maskL *mask, int *stone) {
  *stone = 0;
  return pop(inside, mask);
}
#endif

#endif
