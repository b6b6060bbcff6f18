// The picture: one more sample of every pixel.
#include "camera.cl"
#include "trace.cl"

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets the stone.
static inline void see(world_t world, tile_t *tile, hits_t hits[GROUPS], int column, int row, double jitter_x,
                       double jitter_y) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  for (int group = 0; group < GROUPS; group++) hits[group].count = 0;
  for (int y = 0; y < TILE; y += PACKET_HEIGHT)
    for (int x = 0; x < TILE; x += PACKET_WIDTH) {
      const primaryL primary = primary_rays(world.scene, column + x, row + y, jitter_x, jitter_y);
      rayL ray = {primary.origin, primary.direction, primary.eye, splat(1), unpolarised(primary.direction)};
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
      for (int group = 0; group < GROUPS; group++) {
        const maskL of_group = GROUPS == 1 ? meets : meets & in_group(x, y, group, world.scene->sample);
        if (any_lane(of_group)) note(hits + group, of_group, point, ray, normal, first);
      }
    }
  for (int group = 0; group < GROUPS; group++) fill(hits + group);
}

// Follows the light of all first hits for one index of refraction to its end.
static inline void trace(world_t world, tile_t *tile, pools_t *pools, task_t task, const hits_t *hits) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  for (int next = 0;;) {
    const bool all_begun = next >= hits->count;
    // Light that has come back goes first: it is what makes the pools grow.
    if (REENTRY &&
        (pools->outside.count >= LANES || (all_begun && pools->inside.count == 0 && pools->outside.count > 0)))
      come_back(world, tile, pools, task);
    else if (pools->inside.count >= LANES || (all_begun && pools->inside.count > 0))
      advance(world, tile, pools, task);
    else if (!all_begun) {
      const maskL mask = widen(LANE_INDEX < (intL)(hits->count - next));
      vec3L normal;
      const packetL packet = hits_at(hits, next, &normal);
      if (camera_inside)
        push(&pools->inside, mask, packet);
      else
        enter(world, tile, pools, task, packet, packet.origin, normal, mask);
      next += LANES;
    } else
      return;
  }
}

__kernel void render(__global real4 *image, __constant const parameters_t *scene, __global const real4 *facets,
                     __global const real4 *shadows, __global const real *boxes, __global const int *links,
                     __global const real *corners, __global const chain_t *chains, __global const float *panorama,
                     double jitter_x, double jitter_y, int first_tile_row, int accumulate, __global float *tallies) {
  const world_t world = {scene, facets, shadows, {boxes, links, corners}, chains, panorama};
  const int tile_column = get_global_id(0), tile_row = get_global_id(1) + first_tile_row;
  tile_t tile;
  hits_t hits[GROUPS];
  tile.segments = (intL)(0);
  see(world, &tile, hits, tile_column * TILE, tile_row * TILE, jitter_x, jitter_y);
  if (GEOMETRY != EMPTY) {
    pools_t pools;
    clear(&pools.inside);
    clear(&pools.outside);
    for (int number = 0; number < scene->chains; number++) {
      const chain_t chain = chains[number];
      const uint seed = ((scene->sample * 256 + number) * 8191 + tile_row) * 8191 + tile_column;
      const task_t task = {chain, {CHANNELS == 3 ? 0 : number, CHANNELS}, seed * 0x9e3779b9u};
      const hits_t *seen = hits + (GROUPS == 1 ? 0 : chain.group);
      if (seen->count > 0) trace(world, &tile, &pools, task, seen);
    }
  }
  write_tile(&tile, image, tallies, scene, tile_column, tile_row, accumulate);
}
