// What rays of a pool have in common, and what a packet's weight is to its pixels.
#ifndef CULET_TASK
#define CULET_TASK
#include "packet.cl"
#include "sky.cl"
#include "stones.cl"

// Of sampled wavelengths a chain's numbers differ by the group of a pixel and by its sample: they are looked up by the place in its
// square that a ray is of, and by the group.
#define CHAIN_NUMBERS ((int)(sizeof(chain_t) / sizeof(real)))
#define CHAIN_PLACES (SQUARE * SPECTRAL_GROUPS)
#define COLUMN_OF_SAMPLE CHAIN_NUMBERS // of MANY stones: numbers from its first chain's column to a place's own
#if SPECTRAL
typedef struct {
  real number[CHAIN_NUMBERS + 1][CHAIN_PLACES];
} spectrum_t;
#else
typedef int spectrum_t; // there is none
#endif

// What all rays of a pool have in common while it is worked on.
typedef struct {
  __global const chain_t *chains; // by sample of the batch and group of pixels; of MANY stones those of the first
#if SPECTRAL
  const spectrum_t *spectrum;     // the same by place
#endif
#if STONES == MANY
  int chain; // its number, of each stone's
#endif
  int first_channel;
  uint seed; // of chance
} task_t;

// `spectrum` is to be filled, and has to stay. Of each chain, or each four of them, those of all samples of a batch follow each other.
static inline task_t task_of(world_t world, int level, int chain, uint seed, spectrum_t *spectrum) {
  task_t task;
  const int first = SPECTRAL ? chain << 2 * level : chain;
  task.chains = world.chains + first;
#if SPECTRAL
  for (int place = 0; place < CHAIN_PLACES; place++) {
    const int of_samples = GROUPS * sample_of(level, place % SQUARE) + place / SQUARE;
    __global const real *numbers = (__global const real *)(task.chains + of_samples);
    for (int k = 0; k < CHAIN_NUMBERS; k++) spectrum->number[k][place] = numbers[k];
    spectrum->number[COLUMN_OF_SAMPLE][place] = CHAIN_COLUMNS * MAX_STONES * of_samples;
  }
  task.spectrum = spectrum;
#endif
#if STONES == MANY
  task.chain = first;
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
#define OF_CHAIN(task, tag, quantity) by_place(task, tag, (int)(__builtin_offsetof(chain_t, quantity) / sizeof(real)))
static inline realL by_place(task_t task, intL tag, int number) {
  const real *numbers = task.spectrum->number[number];
#if LANES == 16 && AVX512
  const intL place = (tag & (SQUARE - 1)) | (tag >> (PIXEL_BITS - 4) & SQUARE); // and the lower bit of the group
  const realL low = __builtin_ia32_vpermi2varps512(load_lanes(numbers), place, load_lanes(numbers + LANES));
  const realL high =
      __builtin_ia32_vpermi2varps512(load_lanes(numbers + 2 * LANES), place, load_lanes(numbers + 3 * LANES));
  return blend(widen((tag & 2 << PIXEL_BITS) != 0), high, low);
#else
  return gather_lanes(numbers, (tag & (SQUARE - 1)) | (tag >> (PIXEL_BITS - 4) & (SQUARE * (GROUPS - 1))));
#endif
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
#if SPECTRAL
  const intL before = reals_to_int(by_place(task, packet->tag, COLUMN_OF_SAMPLE));
  return gather_reals(world.columns + column * MAX_STONES, before + (packet->stone & (intL)(MAX_STONES - 1)));
#else
  return by_stone(world, column, packet->stone);
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
