// Fireflies: pixels that a single sample has made bright. For the screen alone; the sums keep every sample.
#include "lanes.cl"

static inline real luminance_of(real4 c) { return (real)0.212639 * c.x + (real)0.715169 * c.y + (real)0.072192 * c.z; }

// A work-item adds one sample of each of `block` pixels, from `begin` to before `end`, to a run of samples, or begins the run
// with it. Of all samples of a pixel the brightest is kept, with its luminance, and the luminance of the next one.
__kernel void collect(__global const real4 *sample, __global real4 *run, int add, __global real4 *brightest,
                      __global real *second, int first_sample, int block, int begin, int end) {
  const int first = begin + get_global_id(0) * block, last = min(first + block, end);
  for (int pixel = first; pixel < last; pixel++) {
    const real4 now = sample[pixel];
    const real bright = luminance_of(now);
    run[pixel] = add ? run[pixel] + now : now;
    if (first_sample) {
      brightest[pixel] = (real4)(now.xyz, bright);
      second[pixel] = 0;
    } else if (bright > brightest[pixel].w) {
      second[pixel] = brightest[pixel].w;
      brightest[pixel] = (real4)(now.xyz, bright);
    } else {
      second[pixel] = max(second[pixel], bright);
    }
  }
}

// The sum of a pixel's samples. If the brightest is more than `ratio` times as bright as the next one, and than `least`, it is
// left out, and the others stand for it.
__kernel void without_fireflies(__global const real4 *earlier, __global const real4 *later, int both,
                                __global const real4 *brightest, __global const real *second, __global real4 *kept,
                                real samples, real ratio, real least, int block, int begin, int end) {
  const int first = begin + get_global_id(0) * block, last = min(first + block, end);
  for (int pixel = first; pixel < last; pixel++) {
    const real4 sum = both ? earlier[pixel] + later[pixel] : earlier[pixel], top = brightest[pixel];
    const int alone = top.w > max(ratio * second[pixel], least);
    kept[pixel] = alone ? (real4)((sum.xyz - top.xyz) * (samples / (samples - 1)), sum.w) : sum;
  }
}
