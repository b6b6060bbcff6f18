// The picture: one more sample of every pixel.
#include "chain.cl"
#include "classic.cl"

#if ESTIMATOR == CLASSIC
typedef classic_work_t work_t;
#define begin_tile begin_classic_tile
#define advance_tile advance_classic_tile
#else
typedef chain_work_t work_t;
#define begin_tile begin_chain_tile
#define advance_tile advance_chain_tile
#endif

// A sample takes as many launches as it needs: each work-item makes `steps` steps, then keeps the tile that it is at in
// `kept` and ends, so that no launch lasts long, whatever a pixel costs. The next launch goes on where this one ended: the
// picture is the same to the last bit.
__kernel void render(WORLD_BUFFERS(AS_ARGUMENT) __global real4 *image, __global const double *jitter, int level,
                     int count, volatile __global uint *progress, int accumulate, __global float *tallies,
                     __global work_t *kept, int steps) {
  const world_t world = {WORLD_BUFFERS(AS_VALUE)};
  const batch_t batch = {jitter, level};
  const int across = tiles_across(scene, batch);
  volatile __global uint *own = progress + OF_ITEMS + ITEM_NUMBERS * get_global_id(0);
  int left = steps;
  work_t work;
  bool under_way = own[UNDER_WAY];
  if (under_way) work = kept[get_global_id(0)];
  while (left > 0) {
    if (!under_way) {
      const int number = deal(progress, count);
      if (number >= count) break;
      begin_tile(&work, number);
    }
    const int tile_column = work.number % across, tile_row = work.number / across;
    under_way = !advance_tile(world, &work, batch, tile_column * TILE, tile_row * TILE, &left);
    if (!under_way) write_tile(&work.tile, batch, image, tallies, scene, tile_column, tile_row, accumulate);
  }
  if (under_way) kept[get_global_id(0)] = work;
  own[UNDER_WAY] = under_way;
  own[STEPS_MADE] = steps - left;
  if (get_global_id(0) == 0) progress[WORK_BYTES] = sizeof(work_t);
}
