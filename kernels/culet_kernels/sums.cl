// A picture's samples are summed in two runs, the earlier and the later; once both are as long they become one.
#include "lanes.cl"

// Adds the later run to the earlier, from pixel `begin` to before `end`. `apart` gets, of each work-item's `block` pixels, the
// sum of the squared differences of the colours; the fourth component is no colour.
__kernel void fold(__global real4 *earlier, __global const real4 *later, __global real *apart, int block, int begin,
                   int end) {
  const int first = begin + get_global_id(0) * block, last = min(first + block, end);
  real sum = 0;
  for (int pixel = first; pixel < last; pixel++) {
    const real4 difference = earlier[pixel] - later[pixel];
    sum += dot(difference.xyz, difference.xyz);
    earlier[pixel] += later[pixel];
  }
  apart[get_global_id(0)] = sum;
}
