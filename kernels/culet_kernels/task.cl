// What rays of a pool have in common, and what a packet's weight is to its pixels.
#ifndef CULET_TASK
#define CULET_TASK
#include "packet.cl"
#include "sky.cl"

// What all rays of a pool have in common while it is worked on.
typedef struct {
  __global const chain_t *chains; // by group of pixels; of MANY stones those of the first
  int first_channel;
  uint seed;                      // of chance
} task_t;

// How many they are is written out, not kept in the task, so that the compiler knows it in functions that it does not inline.
static inline channels_t channels_of(task_t task) {
  const channels_t channels = {task.first_channel, CHANNELS};
  return channels;
}

// A quantity of each lane's chain.
#if SPECTRAL
#define OF_CHAIN(task, tag, quantity)                                                                                  \
  by_group(tag, (task).chains[0].quantity, (task).chains[1].quantity, (task).chains[2].quantity,                       \
           (task).chains[3].quantity)
static inline realL by_group(intL tag, real first, real second, real third, real fourth) {
  const maskL odd = widen((tag >> PIXEL_BITS & 1) != 0), high = widen((tag >> PIXEL_BITS & 2) != 0);
  return blend(high, blend(odd, splat(fourth), splat(third)), blend(odd, splat(second), splat(first)));
}
#else
#define OF_CHAIN(task, tag, quantity) ((task).chains[0].quantity)
#endif

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
