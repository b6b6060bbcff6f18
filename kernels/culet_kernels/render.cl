// The picture: one more sample of every pixel.
#include "trace.cl"

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets the stone.
static inline void see(world_t world, tile_t *tile, hits_t *hits, int column, int row, double jitter_x, double jitter_y) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  hits->count = 0;
  for (int y = 0; y < TILE; y += PACKET_HEIGHT)
    for (int x = 0; x < TILE; x += PACKET_WIDTH) {
      const primaryL primary = primary_rays(world.scene, column + x, row + y, jitter_x, jitter_y);
      rayL ray = {primary.origin, primary.direction, primary.eye, splat(1)};
      vec3L point = along(primary.origin, primary.eye, primary.direction), normal = primary.direction;
      const maskL all = ray.weight > 0;
      maskL meets = camera_inside ? all : !all, open = camera_inside ? !all : all;
      maskL heading = GEOMETRY == EMPTY ? !all : open & passes_stone(ray.origin, ray.direction, ray.start);
      radianceL radiance = black();
      realL cut = splat(0);
      while (any_lane(open)) {
        if (any_lane(heading)) {
          const crossingL entry = stone_entry(world, ray.origin, ray.direction, ray.start, heading);
          const maskL enters = heading & entry.hit & !hidden_by_room(world, ray, entry.t);
          point = blend3(enters, along(ray.origin, entry.t, ray.direction), point);
          normal = blend3(enters, entry.normal, normal);
          meets |= enters;
          open &= !enters;
        }
        heading = open;
        const radianceL seen = gather(world, &ray, splat(1), &heading, &cut, all_channels());
        for (int k = 0; k < 3; k++) radiance.channel[k] += seen.channel[k];
        open = heading;
      }

      const int first = first_pixel(x, y);
      for (int k = 0; k < 3; k++) store_lanes(radiance.channel[k], tile->radiance[k] + first);
      store_lanes(3 * cut, tile->cut + first);
      if (any_lane(meets)) note(hits, meets, point, ray.direction, normal, ray.weight, first);
    }
  fill(hits);
}

__kernel void render(__global real4 *image, __constant const parameters_t *scene, __global const real4 *facets,
                     __global const real4 *shadows, __global const real *boxes, __global const int *links,
                     __global const real *corners, double jitter_x, double jitter_y, int first_tile_row, int accumulate,
                     __global float *tallies) {
  const world_t world = {scene, facets, shadows, {boxes, links, corners}};
  const int tile_column = get_global_id(0), tile_row = get_global_id(1) + first_tile_row;
  tile_t tile;
  hits_t hits;
  tile.segments = (intL)(0);
  see(world, &tile, &hits, tile_column * TILE, tile_row * TILE, jitter_x, jitter_y);
  if (GEOMETRY != EMPTY && hits.count > 0) {
    pools_t pools;
    clear(&pools.inside);
    clear(&pools.outside);
    for (int number = 0; number < CHAINS; number++) {
      const chain_t chain = {number, {CHANNELS == 3 ? 0 : number, CHANNELS}, scene->eta[number]};
      trace(world, &tile, &pools, chain, &hits);
    }
  }
  write_tile(&tile, image, tallies, scene, tile_column, tile_row, accumulate);
}
