// What rays of a pool have in common, and what a packet's weight is to its pixels.
#ifndef CULET_TASK
#define CULET_TASK
#include "packet.cl"
#include "sky.cl"
#include "stones.cl"

// What all rays of a pool have in common while it is worked on.
typedef struct {
  __global const chain_t *chains; // by group of pixels; of MANY stones those of the first
#if STONES == MANY
  int chain;                      // its number, of each stone's
#endif
  int first_channel;
  uint seed; // of chance
} task_t;

static inline task_t task_of(world_t world, int chain, uint seed) {
  task_t task;
  task.chains = world.chains + chain;
#if STONES == MANY
  task.chain = chain;
#endif
  task.first_channel = CHANNELS == 3 ? 0 : chain;
  task.seed = seed * 0x9e3779b9u;
  return task;
}

// How many they are is written out, not kept in the task, so that the compiler knows it in functions that it does not inline.
static inline channels_t channels_of(task_t task) {
  const channels_t channels = {task.first_channel, CHANNELS};
  return channels;
}

// A quantity of each lane's chain.
#if SPECTRAL
#define OF_CHAIN(task, tag, quantity)                                                                                  \
  by_group(tag, splat((task).chains[0].quantity), splat((task).chains[1].quantity), splat((task).chains[2].quantity),  \
           splat((task).chains[3].quantity))
static inline realL by_group(intL tag, realL first, realL second, realL third, realL fourth) {
  const maskL odd = widen((tag >> PIXEL_BITS & 1) != 0), high = widen((tag >> PIXEL_BITS & 2) != 0);
  return blend(high, blend(odd, fourth, third), blend(odd, second, first));
}
#else
#define OF_CHAIN(task, tag, quantity) ((task).chains[0].quantity)
#endif

// The same where it differs by stone too.
#if STONES == MANY
#define ETA 0
#define CHAIN_ABSORPTION 1
static inline realL of_stones_chain(world_t world, task_t task, int quantity, const packetL *packet) {
  const int column = COLUMNS + CHAIN_COLUMNS * task.chain + quantity;
  const realL first = by_stone(world, column, packet->stone);
#if SPECTRAL
  return by_group(packet->tag, first, by_stone(world, column + CHAIN_COLUMNS, packet->stone),
                  by_stone(world, column + 2 * CHAIN_COLUMNS, packet->stone),
                  by_stone(world, column + 3 * CHAIN_COLUMNS, packet->stone));
#else
  return first;
#endif
}
static inline chainL eta_of(world_t world, task_t task, const packetL *packet) {
  return of_stones_chain(world, task, ETA, packet);
}
#else
static inline chainL eta_of(world_t world, task_t task, const packetL *packet) {
  return OF_CHAIN(task, packet->tag, eta);
}
#endif

// What a packet in a stone loses of a weight for each R of the stone's radius.
static inline realL absorption_of(world_t world, task_t task, const packetL *packet, int weight) {
#if STONES == MANY
  return WEIGHTS == 3 ? by_stone(world, COLUMN_ABSORPTION + weight, packet->stone)
                      : of_stones_chain(world, task, CHAIN_ABSORPTION, packet);
#else
  return (realL)(WEIGHTS == 3 ? world.stones->absorption[weight] : OF_CHAIN(task, packet->tag, absorption));
#endif
}

// Where a packet is, which says what axes it has.
#define ABROAD 0   // outside the stones: the frame's
#define ENTERING 1 // at a stone from outside: of MANY those of light inside, else the frame's
#define INSIDE 2   // those of light inside
static inline int at_stone(int place) { return STONES == MANY ? place != ABROAD : place == INSIDE; }

// A direction of a packet that is at_stone, as the frame has it.
static inline vec3L outward_of(world_t world, const packetL *packet, vec3L direction) {
#if STONES == MANY
  return out_of_axes_of(inner_axes_of(world, packet->stone), direction);
#else
  return outward(world.stones, direction);
#endif
}

static inline realL largest_weight(const packetL *packet) {
  realL largest = packet->weight[0];
  for (int k = 1; k < WEIGHTS; k++) largest = fmax(largest, packet->weight[k]);
  return largest;
}

static inline void scale_weights(packetL *packet, realL factor) {
  EACH (k, WEIGHTS) packet->weight[k] *= factor;
}

// What a packet's weight is in a pixel's sum over the three channels.
static inline realL summed_weight(task_t task, const packetL *packet) {
  if (WEIGHTS == 3) return packet->weight[0] + packet->weight[1] + packet->weight[2];
  if (SPECTRAL) return OF_CHAIN(task, packet->tag, summed_share) * packet->weight[0];
  return CHANNELS * packet->weight[0];
}

// The most that a packet's weight can be in a pixel's sum over the three channels. Boundaries to come may turn polarisation
// into intensity.
static inline realL over_channels(task_t task, const packetL *packet) {
  const realL weight = summed_weight(task, packet);
  if (!POLARISED) return weight;
  const polarisationL p = packet->polarisation;
  return weight * (1 + sqrt(p.q * p.q + p.u * p.u + p.v * p.v));
}

#endif
