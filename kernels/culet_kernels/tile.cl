// The pixels that one work-item owns, and how they reach the picture.
#ifndef CULET_TILE
#define CULET_TILE
#include "parameters.cl"

#ifndef TILE // pixels on each side: a multiple of a packet's sides, at most 64, for the bits of a ray's tag
#define TILE 32
#endif
#define TILE_PIXELS (TILE * TILE)

typedef struct {
  real radiance[3][TILE_PIXELS]; // by channel
  real cut[TILE_PIXELS];         // weight that was dropped, summed over the channels
  intL segments;                 // inside the stone
} tile_t;

// Pixels lie packet by packet in a tile, so that a packet is stored as it is.
static inline int first_pixel(int x, int y) {
  return (y / PACKET_HEIGHT * (TILE / PACKET_WIDTH) + x / PACKET_WIDTH) * LANES;
}

static inline int pixel_at(int x, int y) {
  return first_pixel(x, y) + y % PACKET_HEIGHT * PACKET_WIDTH + x % PACKET_WIDTH;
}

// Which pixels of a packet belong to a group: one of each square of four, another one in the next sample.
static inline maskL in_group(int x, int y, int group, int sample) {
  const intL number = ((PACKET_X + x) & 1) + 2 * ((PACKET_Y + y) & 1) + sample;
  return widen((number & 3) == (intL)(group));
}

// Of one sample, by tile: how many segments its chains had inside the stone, and the weight that they dropped, summed over
// pixels. A float counts segments exactly up to 2^24.
#define SEGMENTS 0
#define DROPPED 1
#define TALLIES 2

// Adds the tile to the picture's sums, or begins them. The fourth component is the mean over the channels of what was cut.
static inline void write_tile(const tile_t *tile, __global real4 *image, __global float *tallies,
                              __constant const parameters_t *scene, int tile_column, int tile_row, int accumulate) {
  const int column = tile_column * TILE, row = tile_row * TILE;
  real dropped = 0;
  for (int y = 0; y < TILE && row + y < scene->height; y++)
    for (int x = 0; x < TILE && column + x < scene->width; x++) {
      const int pixel = pixel_at(x, y);
      const real4 sample =
          (real4)(tile->radiance[0][pixel], tile->radiance[1][pixel], tile->radiance[2][pixel], tile->cut[pixel] / 3);
      __global real4 *sum = image + (size_t)(row + y) * scene->width + (column + x);
      *sum = accumulate ? *sum + sample : sample;
      dropped += sample.w;
    }
  int counts[LANES];
  store_ints(tile->segments, counts);
  int total = 0;
  for (int lane = 0; lane < LANES; lane++) total += counts[lane];
  __global float *tally = tallies + TALLIES * (tile_row * get_global_size(0) + tile_column);
  tally[SEGMENTS] = total;
  tally[DROPPED] = dropped;
}

#endif
