// Rays that wait, one row for each quantity, last in, first out. A packet is taken from the end and what survives goes
// back there: packets stay full however unequal the chains are, and the pool stays small enough for the nearest cache.
#ifndef CULET_POOL
#define CULET_POOL
#include "packet.cl"
#include "stones.cl"

// Segments of a chain between two looks at which of the packet's lanes have ended: a lane that idles for a segment costs
// less than sorting the packet each time. Where light waits at facets, a fifth of them leaves the packet in each segment.
#ifndef STRIDE
#define STRIDE (WAITS_AT_FACETS ? 1 : 2)
#endif

// Rays that a pool can hold. Where light can come back to a stone, every packet may leave another one behind in each
// generation, and generations end by weight: some ten for a cut-off of 0.01. What finds no room is counted as cut.
#define POOL_RAYS (REENTRY ? 64 * LANES : 4 * LANES)
#define POOL_SIZE (POOL_RAYS + LANES) // a packet is written whole, and counted as far as it is meant

typedef struct {
  real number[NUMBERS][POOL_SIZE];
  int whole[WHOLES][POOL_SIZE];
  int count;
} pool_t;

// Appends the lanes of a packet that the mask names to rows of `size` numbers.
static inline void append(real *rows, int *wholes, int *count, int size, maskL mask, const packetL *packet) {
  const packing_t packing = packing_of(mask);
  pack_packet(packing, packet, rows + *count, wholes + *count, size);
  *count += packing.count;
}

// Takes up to a packet from the end of such rows; the mask says which lanes hold one. The other lanes hold what was there
// before, which is finite.
__attribute__((always_inline)) static inline packetL take(const real *rows, const int *wholes, int *count, int size,
                                                          maskL *mask) {
  const int start = max(*count - LANES, 0);
  *mask = widen(LANE_INDEX < (intL)(*count - start));
  *count = start;
  return load_packet(rows + start, wholes + start, size);
}

// Empties such rows. Only at their beginning can a packet be taken that is not full.
static inline void empty(real *rows, int *wholes, int *count, int size) {
  *count = 0;
  for (int i = 0; i < LANES; i++) {
    EACH (k, NUMBERS) rows[k * size + i] = 0;
    EACH (k, WHOLES) wholes[k * size + i] = 0;
  }
}

static inline void push(pool_t *pool, maskL mask, const packetL *packet) {
  append(pool->number[0], pool->whole[0], &pool->count, POOL_SIZE, mask, packet);
}
__attribute__((always_inline)) static inline packetL pop(pool_t *pool, maskL *mask) {
  return take(pool->number[0], pool->whole[0], &pool->count, POOL_SIZE, mask);
}
static inline void clear(pool_t *pool) { empty(pool->number[0], pool->whole[0], &pool->count, POOL_SIZE); }

static inline int has_room(const pool_t *pool) { return pool->count <= POOL_RAYS - LANES; }

// Brings a packet to where it meets a stone. Of MANY it then is in the axes of light inside.
static inline void bring(world_t world, packetL *packet, meetingL met) {
  packet->origin = met.point;
#if STONES == MANY
  packet->direction = met.way;
  packet->stone = met.stone;
  if (POLARISED) packet->polarisation.axis = into_axes_of(inner_axes_of(world, met.stone), packet->polarisation.axis);
#endif
}

// Rays inside stones, in the axes of light inside. The facets of a shape are looked at by all lanes of a packet together, so a packet
// is of one shape, whichever stones of that shape its lanes are in. Where there are several shapes, the rays of each have a pool of
// their own, by the number of its first stone. What these have no room for waits in a pile of full packets, the latest on top.
#define PILE 256                   // packets that may wait inside MANY stones; what finds no room is counted as cut
#if STONES == MANY && !ALIKE
#define GATHERING_RAYS (2 * LANES) // that stay in a shape's own pool
#define GATHERING_SIZE (4 * LANES) // a packet more may come, and is written whole

typedef struct {
  real number[NUMBERS][GATHERING_SIZE];
  int whole[WHOLES][GATHERING_SIZE];
  int count;
} gathering_t;

typedef struct {
  real number[PILE][NUMBERS][LANES];
  int whole[PILE][WHOLES][LANES];
  int shape[PILE];
  gathering_t of_shape[MAX_STONES];
  ulong ripe;    // the shapes whose pools hold a packet, a bit each
  int full;      // packets on the pile
  int gathering; // rays in the pools
} inside_t;

static inline void clear_inside(inside_t *inside) {
  inside->full = inside->gathering = 0;
  inside->ripe = 0;
  for (int i = 0; i < MAX_STONES; i++) inside->of_shape[i].count = 0;
}

static inline int is_empty(const inside_t *inside) { return inside->full == 0 && inside->gathering == 0; }

static inline int has_full(const inside_t *inside) { return inside->ripe != 0 || inside->full > 0; }

// Whether a packet has room, whatever stones its lanes are in.
static inline int has_room_inside(const inside_t *inside) { return inside->full <= PILE - LANES; }

__attribute__((always_inline)) static inline void push_to_shape(inside_t *inside, int shape, maskL mask,
                                                                const packetL *packet) {
  gathering_t *own = inside->of_shape + shape;
  const packing_t packing = packing_of(mask);
  pack_packet(packing, packet, own->number[0] + own->count, own->whole[0] + own->count, GATHERING_SIZE);
  own->count += packing.count;
  inside->gathering += packing.count;
  if (own->count > GATHERING_RAYS) {
    own->count -= LANES;
    inside->gathering -= LANES;
    EACH (k, NUMBERS) store_lanes(load_lanes(own->number[k] + own->count), inside->number[inside->full][k]);
    EACH (k, WHOLES) store_ints(load_ints(own->whole[k] + own->count), inside->whole[inside->full][k]);
    inside->shape[inside->full++] = shape;
  }
  if (own->count >= LANES) inside->ripe |= 1ul << shape;
}

// Appends the lanes that the mask names, each to its own stone, of a packet that is in the axes of light inside.
static inline void push_inside(world_t world, inside_t *inside, maskL mask, const packetL *packet) {
  const realL alike = by_stone(world, COLUMN_ALIKE, packet->stone);
  while (any_lane(mask)) {
    const int shape = first_number(mask, reals_to_int(alike));
    const maskL same = mask & (alike == splat((real)shape));
    push_to_shape(inside, shape, same, packet);
    mask &= !same;
  }
}

// Takes a packet of a pool that holds one, else what the largest pool holds: which shape it is of, how many rays, and where
// they begin.
static inline const gathering_t *take_gathered(inside_t *inside, int *shape, int *taken) {
  int from = 0;
  if (inside->ripe != 0)
    from = (int)popcount((inside->ripe & -inside->ripe) - 1);
  else
    for (int i = 1; i < MAX_STONES; i++)
      if (inside->of_shape[i].count > inside->of_shape[from].count) from = i;
  gathering_t *own = inside->of_shape + from;
  *shape = from;
  *taken = min(own->count, LANES);
  if (*taken < LANES) { // no lane holds what was never written
    EACH (k, NUMBERS)
      for (int lane = *taken; lane < LANES; lane++) own->number[k][lane] = own->number[k][0];
    EACH (k, WHOLES)
      for (int lane = *taken; lane < LANES; lane++) own->whole[k][lane] = own->whole[k][0];
  }
  inside->gathering -= *taken;
  own->count -= *taken;
  if (own->count < LANES) inside->ripe &= ~(1ul << from);
  return own;
}

// Takes a packet of one shape: the one on top of the pile, which is the latest that came, so that the pile
// stays small; else what gathered.
__attribute__((always_inline)) static inline packetL pop_inside(inside_t *inside, maskL *mask, int *shape) {
  const real *rows;
  const int *wholes;
  int stride = LANES, taken = LANES;
  if (inside->full > 0) {
    inside->full--;
    *shape = inside->shape[inside->full];
    rows = inside->number[inside->full][0];
    wholes = inside->whole[inside->full][0];
  } else {
    const gathering_t *own = take_gathered(inside, shape, &taken);
    rows = own->number[0] + own->count;
    wholes = own->whole[0] + own->count;
    stride = GATHERING_SIZE;
  }
  *mask = widen(LANE_INDEX < (intL)(taken));
  return load_packet(rows, wholes, stride);
}
#else
#if ALIKE
#define INSIDE_SIZE ((PILE + 1) * LANES)
#else
#define INSIDE_SIZE POOL_SIZE
#endif
typedef struct {
  real number[NUMBERS][INSIDE_SIZE];
  int whole[WHOLES][INSIDE_SIZE];
  int count;
} inside_t;

static inline void clear_inside(inside_t *inside) {
  empty(inside->number[0], inside->whole[0], &inside->count, INSIDE_SIZE);
}
static inline int is_empty(const inside_t *inside) { return inside->count == 0; }
static inline int has_full(const inside_t *inside) { return inside->count >= LANES; }
static inline int has_room_inside(const inside_t *inside) { return inside->count <= INSIDE_SIZE - 2 * LANES; }
static inline void push_to_shape(inside_t *inside, int shape, maskL mask, const packetL *packet) {
  append(inside->number[0], inside->whole[0], &inside->count, INSIDE_SIZE, mask, packet);
}
// A packet that is in the frame, or of MANY in the axes of light inside.
static inline void push_inside(world_t world, inside_t *inside, maskL mask, const packetL *packet) {
  packetL inner = *packet;
#if STONES != MANY
  __constant const stone_t *stone = world.stones;
  inner.origin = inward(stone, packet->origin);
  inner.direction = inward(stone, packet->direction);
  if (POLARISED) inner.polarisation.axis = inward(stone, packet->polarisation.axis);
#endif
  push_to_shape(inside, 0, mask, &inner);
}
__attribute__((always_inline)) static inline packetL pop_inside(inside_t *inside, maskL *mask, int *shape) {
  *shape = 0;
  return take(inside->number[0], inside->whole[0], &inside->count, INSIDE_SIZE, mask);
}
#endif

#if WAITS_AT_FACETS
// Light that has come from inside to a facet which it passes in part. Few lanes of a packet do, so they wait there until they fill a
// packet of their own: Fresnel's formulas and what leaves take as long for few lanes as for all.
#define WAITING_SIZE ((STRIDE + 2) * LANES) // a packet may come in each segment, and is written whole

typedef struct {
  real number[NUMBERS][WAITING_SIZE];
  int whole[WHOLES][WAITING_SIZE];
  real normal[3][WAITING_SIZE]; // of the facet
  int count;
} at_facets_t;

static inline void wait_at_facet(at_facets_t *waiting, maskL mask, const packetL *packet, vec3L normal) {
  const packing_t packing = packing_of(mask);
  const int end = waiting->count;
  pack_packet(packing, packet, waiting->number[0] + end, waiting->whole[0] + end, WAITING_SIZE);
  pack_lanes(packing, normal.x, waiting->normal[0] + end);
  pack_lanes(packing, normal.y, waiting->normal[1] + end);
  pack_lanes(packing, normal.z, waiting->normal[2] + end);
  waiting->count = end + packing.count;
}

// Takes up to a packet of it; some must wait.
__attribute__((always_inline)) static inline packetL take_waiting(at_facets_t *waiting, maskL *mask, vec3L *normal) {
  const int taken = min(waiting->count, LANES);
  for (int lane = taken; lane < LANES; lane++) { // no lane holds what was never written
    EACH (k, NUMBERS) waiting->number[k][lane] = waiting->number[k][0];
    EACH (k, WHOLES) waiting->whole[k][lane] = waiting->whole[k][0];
    EACH (k, 3) waiting->normal[k][lane] = waiting->normal[k][0];
  }
  const int start = waiting->count -= taken;
  *mask = widen(LANE_INDEX < (intL)(taken));
  *normal = vec3(load_lanes(waiting->normal[0] + start), load_lanes(waiting->normal[1] + start),
                 load_lanes(waiting->normal[2] + start));
  return load_packet(waiting->number[0] + start, waiting->whole[0] + start, WAITING_SIZE);
}
#endif

#endif
