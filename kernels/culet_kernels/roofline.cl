// The most that a device can do, to set beside what the renderer does: fused multiply-adds a second, and bytes a second.
#include "lanes.cl"

// Multiply-adds that do not wait for each other: latency (4 cycles) times units (2), and some to spare.
#define ACCUMULATORS 12

// Each work-item does ROUNDS x ACCUMULATORS x LANES multiply-adds. `factor` and `term` come from outside, so that the
// compiler cannot know the result; with a factor below 1 every value stays near term / (1 - factor).
__kernel void multiply_add(__global realL *result, real factor, real term, int rounds) {
  realL value[ACCUMULATORS];
  for (int k = 0; k < ACCUMULATORS; k++) value[k] = splat((real)(get_global_id(0) + k));
  const realL factors = splat(factor), terms = splat(term);
  for (int i = 0; i < rounds; i++)
#pragma unroll
    for (int k = 0; k < ACCUMULATORS; k++) value[k] = fma(value[k], factors, terms);
  realL sum = value[0];
  for (int k = 1; k < ACCUMULATORS; k++) sum += value[k];
  result[get_global_id(0)] = sum;
}

// Reads and writes `packets` packets a work-item, one after the other.
__kernel void copy(__global const realL *from, __global realL *to, int packets) {
  const size_t first = get_global_id(0) * (size_t)packets;
  for (int i = 0; i < packets; i++) to[first + i] = from[first + i];
}
