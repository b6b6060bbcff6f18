// Polygons of light on the maps of floor and walls, by their exact areas: every side adds to an accumulation buffer how
// much of each texel lies right of it, and one running sum along the rows makes of all sides the light of each texel.
//
// The signed-area raster is that of FreeType and font-rs; here it sums polygons that overlap, as light does, and shadows
// are polygons of negative light. Cost goes with the length of the sides, not with the area.
#ifndef CULET_RASTER
#define CULET_RASTER
#include "parameters.cl"

#define MAP_STRIDE 514         // of a row in the accumulation buffer: a side may end right of the last texel
#define THIN ((real)1e-5)      // texels^2 of area, and
#define THIN_SIDE ((real)1e-4) // texels, below which a polygon of so much length is a line: its area is rounding

#define MAP_BLOCK 16           // texels of a row that are marked together: a row's marks are the bits of a uint

// Marks the blocks of texels from one to another as touched. What is right of the map is not summed.
static inline void touch(__global uint *row, int first, int last) {
  const int a = min(first / MAP_BLOCK, 31), b = min(last / MAP_BLOCK, 31);
  *row |= (~0u << a) & (~0u >> (31 - b));
}

// A line from (x0, y0) to (x1, y1), in texels, of `height` per texel.
#define RASTER_SIDE(name, type)                                                                                        \
  static inline void name(__global type *buffer, __global uint *touched, real x0, real y0, real x1, real y1,           \
                          type height) {                                                                               \
    if (y0 == y1) return;                                                                                              \
    if (y0 > y1) {                                                                                                     \
      const real x = x0, y = y0;                                                                                       \
      x0 = x1;                                                                                                         \
      x1 = x;                                                                                                          \
      y0 = y1;                                                                                                         \
      y1 = y;                                                                                                          \
      height = -height;                                                                                                \
    }                                                                                                                  \
    if (y1 <= 0 || y0 >= MAP_SIZE) return;                                                                             \
    const real slope = (x1 - x0) / (y1 - y0);                                                                          \
    if (y0 < 0) {                                                                                                      \
      x0 -= y0 * slope;                                                                                                \
      y0 = 0;                                                                                                          \
    }                                                                                                                  \
    y1 = fmin(y1, (real)MAP_SIZE);                                                                                     \
    if (x0 >= MAP_SIZE && x0 + (y1 - y0) * slope >= MAP_SIZE) return;                                                  \
    const int last = (int)ceil(y1);                                                                                    \
    real x = x0, top = y0;                                                                                             \
    for (int row = (int)y0; row < last; row++) {                                                                       \
      const real bottom = fmin((real)(row + 1), y1), part = bottom - top, next = x + slope * part;                     \
      const type d = height * (float)part;                                                                             \
      const real from = clamp(fmin(x, next), (real)0, (real)MAP_SIZE),                                                 \
                 to = clamp(fmax(x, next), (real)0, (real)MAP_SIZE);                                                   \
      const int first = (int)from, end = (int)ceil(to);                                                                \
      touch(touched + row, first, max(end, first + 1));                                                                \
      __global type *texel = buffer + row * MAP_STRIDE + first;                                                        \
      if (end <= first + 1) {                                                                                          \
        const float middle = (float)((real)0.5 * (from + to) - first);                                                 \
        texel[0] += d - d * middle;                                                                                    \
        texel[1] += d * middle;                                                                                        \
      } else { /* how much of the line lies in each texel, and left of it in the next */                               \
        const real s = 1 / (to - from), f = from - first, g = to - end + 1;                                            \
        const real begins = (real)0.5 * s * (1 - f) * (1 - f), ends = (real)0.5 * s * g * g;                           \
        const int steps = end - first;                                                                                 \
        texel[0] += d * (float)begins;                                                                                 \
        if (steps == 2)                                                                                                \
          texel[1] += d * (float)(1 - begins - ends);                                                                  \
        else {                                                                                                         \
          const real second = s * ((real)1.5 - f);                                                                     \
          texel[1] += d * (float)(second - begins);                                                                    \
          for (int i = 2; i < steps - 1; i++) texel[i] += d * (float)s;                                                \
          texel[steps - 1] += d * (float)(1 - (second + (steps - 3) * s) - ends);                                      \
        }                                                                                                              \
        texel[steps] += d * (float)ends;                                                                               \
      }                                                                                                                \
      x = next;                                                                                                        \
      top = bottom;                                                                                                    \
    }                                                                                                                  \
  }
RASTER_SIDE(raster_side, float4)
RASTER_SIDE(raster_shade, float)

// Light of a texel at (x, y), in units of a texel's.
static inline void strew(__global float4 *buffer, __global uint *touched, real x, real y, float4 light) {
  if (!(x >= 0 && y >= 0 && x < MAP_SIZE && y < MAP_SIZE)) return;
  __global float4 *texel = buffer + (int)y * MAP_STRIDE + (int)x;
  touch(touched + (int)y, (int)x, (int)x + 1);
  texel[0] += light;
  texel[1] -= light;
}

// A polygon's signed area, in the units of its corners.
static inline real polygon_area(const real *x, const real *y, int count) {
  real area = 0;
  for (int i = 1; i + 1 < count; i++) area += (x[i] - x[0]) * (y[i + 1] - y[0]) - (x[i + 1] - x[0]) * (y[i] - y[0]);
  return (real)0.5 * area;
}

// A polygon of so much light in all, in texels' light. One too thin to have an area of its own is strewn along its length.
static inline void raster_polygon(__global float4 *buffer, __global uint *touched, const real *x, const real *y,
                                  int count, float4 light) {
  const real area = polygon_area(x, y, count);
  int left = 0, right = 0, top = 0, bottom = 0;
  for (int i = 1; i < count; i++) {
    if (x[i] < x[left]) left = i;
    if (x[i] > x[right]) right = i;
    if (y[i] < y[top]) top = i;
    if (y[i] > y[bottom]) bottom = i;
  }
  if (y[bottom] <= 0 || y[top] >= MAP_SIZE || x[right] <= 0 || x[left] >= MAP_SIZE) return;
  const real wide = x[right] - x[left], high = y[bottom] - y[top], extent = fmax(wide, high);
  if (fabs(area) > THIN + THIN_SIDE * extent) {
    const float4 height = light * (float)(-1 / area);
    for (int i = 0; i < count; i++) {
      const int next = i + 1 == count ? 0 : i + 1;
      raster_side(buffer, touched, x[i], y[i], x[next], y[next], height);
    }
    return;
  }
  const int a = wide > high ? left : top, b = wide > high ? right : bottom;
  const int steps = (int)fmin(extent, (real)MAP_SIZE) + 1;
  for (int i = 0; i < steps; i++) {
    const real part = (i + (real)0.5) / steps;
    strew(buffer, touched, x[a] + part * (x[b] - x[a]), y[a] + part * (y[b] - y[a]), light / steps);
  }
}

#endif
