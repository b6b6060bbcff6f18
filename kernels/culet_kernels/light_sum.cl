// From what was accumulated of all work-items to the maps of floor and walls, by running sums along the rows; the buffers
// are left empty for the next pass. What is not marked as touched is empty, and neither read nor written.
#include "light_beam.cl"

// Adds the blocks that other work-items touched to the first one's row, and empties them. Returns the marks of all.
#define GATHER_ROW(name, type)                                                                                         \
  static inline uint name(__global type *row, __global uint *touched, size_t texels, size_t rows, int copies) {        \
    uint marks = *touched;                                                                                             \
    *touched = 0;                                                                                                      \
    for (int copy = 1; copy < copies; copy++) {                                                                        \
      __global type *other = row + copy * texels;                                                                      \
      const uint more = touched[copy * rows];                                                                          \
      touched[copy * rows] = 0;                                                                                        \
      marks |= more;                                                                                                   \
      for (uint left = more; left; left &= left - 1) {                                                                 \
        const int begin = MAP_BLOCK * (31 - clz(left & -left));                                                        \
        for (int x = begin; x < begin + MAP_BLOCK; x++) {                                                              \
          row[x] += other[x];                                                                                          \
          other[x] = 0;                                                                                                \
        }                                                                                                              \
      }                                                                                                                \
    }                                                                                                                  \
    return marks;                                                                                                      \
  }
GATHER_ROW(gather_light, float4)
GATHER_ROW(gather_shade, float)

// Light of a point without falloff that a texel of a matte surface would have, of colour 1: the cosine to it.
static inline float unshaded(__constant const throwing_t *room, int s, __constant const light_t *light, real u,
                             real v) {
  real way[3];
  for (int k = 0; k < 3; k++)
    way[k] =
        light->place[k] - (room->across[s][k] * u + room->up[s][k] * v + room->surface[s][k] * room->surface[s][3]);
  real cosine = 0;
  for (int k = 0; k < 3; k++) cosine += room->surface[s][k] * way[k];
  return (float)fmax(cosine * rsqrt(fmax(dot_3(way, way), (real)1e-12)), (real)0);
}

// Most of a map is even, and far more than caches hold: what is stored need not be read before.
static inline void store_past_caches(float16 values, __global float *to) {
#if __has_builtin(__builtin_nontemporal_store)
  __builtin_nontemporal_store(values, (__global float16 *)to);
#else
  vstore16(values, 0, to);
#endif
}

// Each work-item takes rows by turns. The map becomes keep x what it was + gain x what is summed.
__kernel void sum_map(__constant const throwing_t *room, __constant const light_t *points, __global float4 *light_maps,
                      __global float *shade_maps, __global uint *lit_rows, __global uint *shaded_rows, int copies,
                      __global float *map, float keep, float gain) {
  const int rows = room->maps * MAP_LEVELS * MAP_SIZE, items = get_global_size(0);
  const size_t whole = (size_t)rows * MAP_STRIDE;
  for (int row = get_global_id(0); row < rows; row += items) {
    __global float4 *light = light_maps + (size_t)row * MAP_STRIDE;
    __global float *texel = map + (size_t)row * MAP_SIZE * 3;
    const uint marks = gather_light(light, lit_rows + row, whole, rows, copies);
    float4 sum = 0;
    for (int block = 0; block < MAP_SIZE / MAP_BLOCK; block++) {
      const int touched = marks >> block & 1;
      if (keep == 0 && !touched) { // as before
        const float4 even = gain * sum;
        __global float *to = texel + 3 * block * MAP_BLOCK;
        const float16 first = even.xyzxyzxyzxyzxyzx, second = even.yzxyzxyzxyzxyzxy, third = even.zxyzxyzxyzxyzxyz;
        store_past_caches(first, to);
        store_past_caches(second, to + 16);
        store_past_caches(third, to + 32);
        continue;
      }
      for (int x = block * MAP_BLOCK; x < (block + 1) * MAP_BLOCK; x++) {
        if (touched) {
          sum += light[x];
          light[x] = 0;
        }
        texel[3 * x] = keep != 0 ? keep * texel[3 * x] + gain * sum.x : gain * sum.x;
        texel[3 * x + 1] = keep != 0 ? keep * texel[3 * x + 1] + gain * sum.y : gain * sum.y;
        texel[3 * x + 2] = keep != 0 ? keep * texel[3 * x + 2] + gain * sum.z : gain * sum.z;
      }
    }
    const int level = row / MAP_SIZE % MAP_LEVELS, s = row / (MAP_SIZE * MAP_LEVELS);
    const real size = room->half_size[level] * 2 / MAP_SIZE;
    const real v = room->centre[s][1] - room->half_size[level] + (row % MAP_SIZE + (real)0.5) * size;
    for (int point = 0; point < room->points; point++) {
      __global float *shade = shade_maps + point * whole + (size_t)row * MAP_STRIDE;
      const uint marked = gather_shade(shade, shaded_rows + point * rows + row, whole * room->points,
                                       (size_t)rows * room->points, copies);
      const int all = points[point].inside >= 0; // a stone is about the point
      if (!marked && !all) continue;
      float covered = all;
      for (int x = 0; x < MAP_SIZE; x++) {
        if (marked >> (x / MAP_BLOCK) & 1) {
          covered += shade[x];
          shade[x] = 0;
        }
        if (fabs(covered) < 1e-4f) continue; // rounding
        const real u = room->centre[s][0] - room->half_size[level] + (x + (real)0.5) * size;
        const float taken = gain * clamp(covered, 0.0f, 1.0f) * unshaded(room, s, points + point, u, v);
        for (int k = 0; k < 3; k++) texel[3 * x + k] -= taken * points[point].colour[k];
      }
    }
  }
}
