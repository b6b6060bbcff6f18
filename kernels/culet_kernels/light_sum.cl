// From what was accumulated of all work-items to the maps of floor and walls, by running sums along the rows; the buffers
// are left empty for the next pass.
#include "light_beam.cl"

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

// Each work-item takes rows by turns. The map becomes keep x what it was + gain x what is summed.
__kernel void sum_map(__constant const throwing_t *room, __constant const light_t *points, __global float4 *light_maps,
                      __global float *shade_maps, int copies, __global float *map, float keep, float gain) {
  const int rows = room->maps * MAP_LEVELS * MAP_SIZE, items = get_global_size(0);
  const size_t whole = (size_t)rows * MAP_STRIDE;
  for (int row = get_global_id(0); row < rows; row += items) {
    __global float4 *light = light_maps + (size_t)row * MAP_STRIDE;
    __global float *texel = map + (size_t)row * MAP_SIZE * 3;
    for (int copy = 1; copy < copies; copy++) {
      __global float4 *other = light + copy * whole;
      for (int x = 0; x < MAP_STRIDE; x++) {
        light[x] += other[x];
        other[x] = 0;
      }
    }
    float4 sum = 0;
    for (int x = 0; x < MAP_SIZE; x++) {
      sum += light[x];
      light[x] = 0;
      for (int k = 0; k < 3; k++) {
        const float value = k == 0 ? sum.x : k == 1 ? sum.y : sum.z;
        texel[3 * x + k] = keep != 0 ? fma(keep, texel[3 * x + k], gain * value) : gain * value;
      }
    }
    light[MAP_SIZE] = light[MAP_SIZE + 1] = 0;
    const int level = row / MAP_SIZE % MAP_LEVELS;
    const int s = row / (MAP_SIZE * MAP_LEVELS);
    const real size = room->half_size[level] * 2 / MAP_SIZE;
    const real v = room->centre[s][1] - room->half_size[level] + (row % MAP_SIZE + (real)0.5) * size;
    for (int point = 0; point < room->points; point++) {
      __global float *shade = shade_maps + point * whole + (size_t)row * MAP_STRIDE;
      for (int copy = 1; copy < copies; copy++) {
        __global float *other = shade + copy * whole * room->points;
        for (int x = 0; x < MAP_STRIDE; x++) {
          shade[x] += other[x];
          other[x] = 0;
        }
      }
      float covered = 0;
      for (int x = 0; x < MAP_SIZE; x++) {
        covered += shade[x];
        shade[x] = 0;
        if (fabs(covered) < 1e-4f) continue; // rounding
        const real u = room->centre[s][0] - room->half_size[level] + (x + (real)0.5) * size;
        const float taken = gain * clamp(covered, 0.0f, 1.0f) * unshaded(room, s, points + point, u, v);
        for (int k = 0; k < 3; k++) texel[3 * x + k] -= taken * points[point].colour[k];
      }
      shade[MAP_SIZE] = shade[MAP_SIZE + 1] = 0;
    }
  }
}
