// The tile of pixels that a work-item is at: how it gets it, and how the tile reaches the picture.
#ifndef CULET_TILE
#define CULET_TILE
#include "batch.cl"

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

// Pixels lie packet by packet in a tile, so that a packet is stored as it is, and the packets of a square one after the
// other, so that a pixel's number tells where it is in its square.
static inline int first_pixel(int x, int y) {
  return (y / SQUARE_SIDE * (TILE / SQUARE_SIDE) + x / SQUARE_SIDE) * SQUARE + first_in_square(x, y);
}

static inline int pixel_at(int x, int y) {
  return first_pixel(x, y) + y % PACKET_HEIGHT * PACKET_WIDTH + x % PACKET_WIDTH;
}

// The tile's rows, or columns, that are in the picture, of a batch.
static inline int shown(batch_t batch, int first, int size) { return min(TILE, (size << batch.level) - first); }

// Of one sample, by tile: how many segments its chains had inside the stone, and the weight that they dropped, summed over
// pixels. A float counts segments exactly up to 2^24.
#define SEGMENTS 0
#define DROPPED 1
#define TALLIES 2

static inline int tiles_across(__constant const parameters_t *scene, batch_t batch) {
  return ((scene->width << batch.level) + TILE - 1) / TILE;
}

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

static inline real4 one_of(const tile_t *tile, int pixel) {
  return (real4)((real)tile->radiance[0][pixel], (real)tile->radiance[1][pixel], (real)tile->radiance[2][pixel],
                 tile->cut[pixel] / 3);
}

// The sum of a pixel's 4^level samples in a tile, from this column and row on.
static inline real4 sum_of_samples(const tile_t *tile, int level, int x, int y) {
  real4 sum = one_of(tile, pixel_at(x, y));
  for (int i = 1; i < 1 << 2 * level; i++)
    sum += one_of(tile, pixel_at(x + (i & ((1 << level) - 1)), y + (i >> level)));
  return sum;
}

// Adds a row of a tile's pixels to the picture's sums, or begins them; returns the weight that was dropped.
static inline real add_row(const tile_t *tile, int level, int y, __global real4 *sums, int columns, int accumulate) {
  real dropped = 0;
  for (int x = 0; x < columns; x++) {
    const real4 samples = sum_of_samples(tile, level, x << level, y << level);
    sums[x] = accumulate ? sums[x] + samples : samples;
    dropped += samples.w;
  }
  return dropped;
}

// Adds the tile to the picture's sums, or begins them. The fourth component is the mean over the channels of what was cut.
static inline void write_tile(const tile_t *tile, batch_t batch, __global real4 *image, __global float *tallies,
                              __constant const parameters_t *scene, int tile_column, int tile_row, int accumulate) {
  const int side = TILE >> batch.level, column = tile_column * side, row = tile_row * side;
  real dropped = 0;
  const int columns = min(side, scene->width - column), rows = min(side, scene->height - row);
  __global real4 *sums = image + (size_t)row * scene->width + column;
  for (int y = 0; y < min(rows, ROWS_AHEAD); y++) expect_row(sums + (size_t)y * scene->width, columns);
  for (int y = 0; y < rows; y++) {
    if (y + ROWS_AHEAD < rows) expect_row(sums + (size_t)(y + ROWS_AHEAD) * scene->width, columns);
    __global real4 *own = sums + (size_t)y * scene->width;
    if (batch.level == 0)
      dropped += add_row(tile, 0, y, own, columns, accumulate);
    else
      dropped += add_row(tile, batch.level, y, own, columns, accumulate);
  }
  int counts[LANES];
  store_ints(tile->segments, counts);
  float total = 0;
  for (int lane = 0; lane < LANES; lane++) total += counts[lane];
  __global float *tally = tallies + TALLIES * (tile_row * tiles_across(scene, batch) + tile_column);
  tally[SEGMENTS] = total;
  tally[DROPPED] = dropped;
}

#endif
