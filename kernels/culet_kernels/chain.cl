// The estimator by chains: what a tile's pixels see without the stone, and then, by chains, in it.
#ifndef CULET_CHAIN
#define CULET_CHAIN
#include "camera.cl"
#include "trace.cl"

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets the stone.
static inline void see(world_t world, tile_t *tile, hits_t *hits, int column, int row, double jitter_x,
                       double jitter_y) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  hits->count = 0;
  const int columns = shown(column, world.scene->width), rows = shown(row, world.scene->height);
  for (int y = 0; y < rows; y += PACKET_HEIGHT)
    for (int x = 0; x < columns; x += PACKET_WIDTH) {
      const primaryL primary = primary_rays(world.scene, column + x, row + y, jitter_x, jitter_y);
      rayL ray = {primary.origin, primary.direction, primary.eye, splat(1), unpolarised(primary.direction)};
      vec3L point = along(primary.origin, primary.eye, primary.direction), normal = primary.direction;
      const maskL all = in_picture(world.scene, column + x, row + y), none = all & !all;
      maskL meets = camera_inside ? all : none, open = camera_inside ? none : all;
      maskL heading = GEOMETRY == EMPTY ? none : open & passes_stone(ray.origin, ray.direction, ray.start);
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
        EACH (k, 3) radiance.channel[k] += seen.channel[k];
        open = heading;
      }
      const int first = first_pixel(x, y);
      EACH (k, 3) store_lanes(radiance.channel[k], tile->radiance[k] + first);
      store_lanes(3 * cut, tile->cut + first);
      const intL tag = first + LANE_INDEX + (groups_of(x, y, world.scene->sample) << PIXEL_BITS);
      if (any_lane(meets)) note(hits, meets, point, ray, normal, tag);
    }
  fill(hits);
}

// Follows the light of all first hits along one chain each to its end.
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
      packetL packet = hits_at(hits, next, &normal);
      if (camera_inside)
        push(&pools->inside, mask, &packet);
      else
        enter(world, tile, pools, task, &packet, packet.origin, normal, mask);
      next += LANES;
    } else
      return;
  }
}

static inline void chain_tile(world_t world, tile_t *tile, int column, int row, double jitter_x, double jitter_y) {
  __constant const parameters_t *scene = world.scene;
  hits_t hits;
  see(world, tile, &hits, column, row, jitter_x, jitter_y);
  if (GEOMETRY != EMPTY) {
    pools_t pools;
    clear(&pools.inside);
    clear(&pools.outside);
    for (int number = 0; number < scene->chains && hits.count > 0; number += GROUPS) {
      const uint seed = (((uint)scene->sample * 256 + number) * 8191 + row / TILE) * 8191 + column / TILE;
      const task_t task = {world.chains + number, CHANNELS == 3 ? 0 : number, seed * 0x9e3779b9u};
      trace(world, tile, &pools, task, &hits);
    }
  }
}

#endif
