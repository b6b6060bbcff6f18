// What differs by stone, for packets whose lanes are in different stones: the processor looks it up in columns by stone.
#ifndef CULET_STONE_COLUMNS
#define CULET_STONE_COLUMNS
#include "features.cl"
#include "vector.cl"
#include "world.cl"

#if STONES == MANY
// The number of each lane's stone in a column. A lane that names no stone takes that of any.
static inline realL by_stone(world_t world, int column, intL stone) {
  __global const real *numbers = world.columns + column * MAX_STONES;
#if LANES == 16 && AVX512
  __global const anywhereL *part = (__global const anywhereL *)numbers; // 32 stones are in two registers
  realL found = __builtin_ia32_vpermi2varps512(part[0], stone, part[1]);
  if (world.scene->stones > 32)
    found = blend(widen(stone >= 32), __builtin_ia32_vpermi2varps512(part[2], stone, part[3]), found);
  return found;
#else
  int place[LANES];
  real own[LANES];
  store_ints(stone & (intL)(MAX_STONES - 1), place);
  for (int lane = 0; lane < LANES; lane++) own[lane] = numbers[place[lane]];
  return load_lanes(own);
#endif
}

static inline vec3L vector_by_stone(world_t world, int column, intL stone) {
  return vec3(by_stone(world, column, stone), by_stone(world, column + 1, stone), by_stone(world, column + 2, stone));
}

// Each lane's inner axes, as rows.
typedef struct {
  vec3L row[3];
} axesL;

static inline axesL inner_axes_of(world_t world, intL stone) {
  axesL axes;
  EACH (k, 3) axes.row[k] = vector_by_stone(world, COLUMN_INNER_AXES + 3 * k, stone);
  return axes;
}

static inline vec3L into_axes_of(axesL axes, vec3L v) {
  return along(along(scale3(v.x, axes.row[0]), v.y, axes.row[1]), v.z, axes.row[2]);
}
static inline vec3L out_of_axes_of(axesL axes, vec3L v) {
  return vec3(dot3(axes.row[0], v), dot3(axes.row[1], v), dot3(axes.row[2], v));
}

// A position in the frame of one in the measure of each lane's stone.
static inline vec3L to_frame(world_t world, intL stone, vec3L point) {
  return along(vector_by_stone(world, COLUMN_CENTRE, stone), by_stone(world, COLUMN_RADIUS, stone), point);
}
#endif

#endif
