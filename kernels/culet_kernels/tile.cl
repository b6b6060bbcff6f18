// The tile of pixels that a work-item is at: how it gets it, and how the tile reaches the picture.
#ifndef CULET_TILE
#define CULET_TILE
#include "features.cl"
#include "parameters.cl"

// Pixels on each side: a multiple of a packet's sides, at most 64, for the bits of a ray's tag. Rays of each of several stones
// gather to packets of their own, which takes more of them.
#define TILE_OF_ONE 48
#define TILE_OF_MANY 64
#define TILE (STONES == MANY ? TILE_OF_MANY : TILE_OF_ONE)
#define TILE_PIXELS (TILE * TILE)
// Packets of a tile's pixels, row by row.
#define PACKETS_ACROSS (TILE / PACKET_WIDTH)
#define PACKETS (TILE_PIXELS / LANES)

// A pixel's sum. Where light comes back to the same directions for thousands of reflections, or goes to and fro between faces of
// stones that touch, thousands of small terms are added, each of which single precision would round the same way or leave out.
#if FEW_MIRRORS || STONES == MANY
typedef double sum_t;
static inline void begin_sums(realL value, sum_t *to) {
  real lanes[LANES];
  store_lanes(value, lanes);
  for (int lane = 0; lane < LANES; lane++) to[lane] = lanes[lane];
}
#else
typedef real sum_t;
static inline void begin_sums(realL value, sum_t *to) { store_lanes(value, to); }
#endif

typedef struct {
  sum_t radiance[3][TILE_PIXELS]; // by channel
  real cut[TILE_PIXELS];          // weight that was dropped, summed over the channels
  intL segments;                  // inside the stone
} tile_t;

// Pixels lie packet by packet in a tile, so that a packet is stored as it is.
static inline int first_pixel(int x, int y) {
  return (y / PACKET_HEIGHT * (TILE / PACKET_WIDTH) + x / PACKET_WIDTH) * LANES;
}

static inline int pixel_at(int x, int y) {
  return first_pixel(x, y) + y % PACKET_HEIGHT * PACKET_WIDTH + x % PACKET_WIDTH;
}

// The tile's rows, or columns, that are in the picture.
static inline int shown(int first, int size) { return min(TILE, size - first); }

// Which pixels of a packet are in the picture.
static inline maskL in_picture(__constant const parameters_t *scene, int x, int y) {
  return widen((x + PACKET_X < (intL)(scene->width)) & (y + PACKET_Y < (intL)(scene->height)));
}

// The groups that a packet's pixels belong to: the four of each square, in the next sample the next ones.
static inline intL groups_of(int x, int y, int sample) {
  return ((((PACKET_X + x) & 1) + 2 * ((PACKET_Y + y) & 1) + sample) & 3) % GROUPS;
}

// Of one sample, by tile: how many segments its chains had inside the stone, and the weight that they dropped, summed over
// pixels. A float counts segments exactly up to 2^24.
#define SEGMENTS 0
#define DROPPED 1
#define TALLIES 2

static inline int tiles_across(__constant const parameters_t *scene) { return (scene->width + TILE - 1) / TILE; }

// How far a sample is, over all of its launches. The host sets it to 0 before the first of them.
#define TILES_DEALT 0 // so many tiles were taken, maybe more than there are
#define WORK_BYTES 1  // the size of what a work-item keeps of a tile under way
#define OF_ITEMS 2    // from here on for each work-item:
#define UNDER_WAY 0   // whether it keeps a tile that is not done,
#define STEPS_MADE 1  // and how many steps it has made in the last launch
#define ITEM_NUMBERS 2

// A sample's tiles are dealt out one by one: a work-item stands for a core and takes the next tile until there are no more,
// so that cores end together however unequal tiles are (persistent threads: T. Aila and S. Laine, Understanding the
// efficiency of ray traversal on GPUs, HPG 2009). Returns the number of a tile that nobody else has, or `count` if there
// is none.
static inline int deal(volatile __global uint *progress, int count) {
  if (progress[TILES_DEALT] >= (uint)count) return count; // it grows no further, however many launches look
  return min(atomic_inc(progress + TILES_DEALT), (uint)count);
}

// Rows of a tile of the picture's sums that are on their way to the cache while one is added to: each is a page of its own,
// and the processor foresees none of them.
#define ROWS_AHEAD 3
#define LINE_BYTES 64 // of a cache

static inline void expect_row(__global const real4 *sums, int pixels) {
#if __has_builtin(__builtin_prefetch)
  for (size_t at = (size_t)sums, end = at + pixels * sizeof(real4); at < end; at += LINE_BYTES)
    __builtin_prefetch((const void *)at, 1);
#endif
}

// Adds the tile to the picture's sums, or begins them. The fourth component is the mean over the channels of what was cut.
static inline void write_tile(const tile_t *tile, __global real4 *image, __global float *tallies,
                              __constant const parameters_t *scene, int tile_column, int tile_row, int accumulate) {
  const int column = tile_column * TILE, row = tile_row * TILE;
  real dropped = 0;
  const int columns = shown(column, scene->width), rows = shown(row, scene->height);
  __global real4 *sums = image + (size_t)row * scene->width + column;
  for (int y = 0; y < min(rows, ROWS_AHEAD); y++) expect_row(sums + (size_t)y * scene->width, columns);
  for (int y = 0; y < rows; y++) {
    if (y + ROWS_AHEAD < rows) expect_row(sums + (size_t)(y + ROWS_AHEAD) * scene->width, columns);
    for (int x = 0; x < columns; x++) {
      const int pixel = pixel_at(x, y);
      const real4 sample = (real4)((real)tile->radiance[0][pixel], (real)tile->radiance[1][pixel],
                                   (real)tile->radiance[2][pixel], tile->cut[pixel] / 3);
      __global real4 *sum = sums + (size_t)y * scene->width + x;
      *sum = accumulate ? *sum + sample : sample;
      dropped += sample.w;
    }
  }
  int counts[LANES];
  store_ints(tile->segments, counts);
  float total = 0;
  for (int lane = 0; lane < LANES; lane++) total += counts[lane];
  __global float *tally = tallies + TALLIES * (tile_row * tiles_across(scene) + tile_column);
  tally[SEGMENTS] = total;
  tally[DROPPED] = dropped;
}

#endif
