// The picture: one more sample of every pixel.
#include "chain.cl"
#include "classic.cl"

__kernel void render(__global real4 *image, __constant const parameters_t *scene, __global const real4 *facets,
                     __global const real4 *shadows, __global const real *boxes, __global const int *links,
                     __global const real *corners, __global const chain_t *chains, __global const float *panorama,
                     double jitter_x, double jitter_y, int first_tile, int count, volatile __global uint *dealt,
                     int accumulate, __global float *tallies) {
  const world_t world = {scene, facets, shadows, {boxes, links, corners}, chains, panorama};
  const int across = tiles_across(scene);
  for (int number; (number = deal(dealt, count)) < count;) {
    const int tile_column = (first_tile + number) % across, tile_row = (first_tile + number) / across;
    const int column = tile_column * TILE, row = tile_row * TILE;
    tile_t tile;
    tile.segments = (intL)(0);
    if (ESTIMATOR == CLASSIC)
      classic_tile(world, &tile, column, row, jitter_x, jitter_y);
    else
      chain_tile(world, &tile, column, row, jitter_x, jitter_y);
    write_tile(&tile, image, tallies, scene, tile_column, tile_row, accumulate);
  }
}
