// What becomes of the light of one pixel of a picture, in one sample: the renderer's own chains, with each event written down.
#undef LANES
#define LANES 1
#undef RECORDED
#define RECORDED 1
#include "chain.cl"

// Follows all chains of the pixel, or as many steps as are left. `work` holds what it is at between launches.
__kernel void path(WORLD_BUFFERS(AS_ARGUMENT) __global record_t *record, __global happening_t *events, int column,
                   int row, __global const double *jitter, __global chain_work_t *work, int begins, int steps) {
  const world_t world = {WORLD_BUFFERS(AS_VALUE) record, events};
  const batch_t one_sample = {jitter, 0};
  const int first_column = column / TILE * TILE, first_row = row / TILE * TILE;
  const int pixel = pixel_at(column % TILE, row % TILE);
  chain_work_t own;
  if (begins) {
    begin_chain_tile(&own, 0);
    own.packet = row % TILE * TILE + column % TILE;
    int one = 1;
    see(world, &own, one_sample, first_column, first_row, &one);
    own.packet = PACKETS;
  } else
    own = *work;
  record->done = advance_chain_tile(world, &own, one_sample, first_column, first_row, &steps);
  for (int k = 0; k < 3; k++) record->radiance[k] = (real)own.tile.radiance[k][pixel];
  record->cut = own.tile.cut[pixel];
  if (!record->done) *work = own;
}

// The bytes of what is held between launches.
__kernel void path_bytes(__global int *bytes) { *bytes = sizeof(chain_work_t); }
