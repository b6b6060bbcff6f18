// The estimator by chains: what a tile's pixels see without the stone, and then, by chains, in it.
#ifndef CULET_CHAIN
#define CULET_CHAIN
#include "camera.cl"
#include "trace.cl"

// The stone in a studio floor: of `glossy` rays, which end at the floor, those that a smooth floor would send to the stone.
// For them `ray` goes on there, with the floor's reflectance for its weight, and what they showed gives way to it. From
// sample to sample the floor is tilted a little, which softens what is seen far above it.
static inline maskL mirrored_in_floor(world_t world, rayL *ray, maskL glossy, double jitter_x, double jitter_y,
                                      vec3L *point, vec3L *normal, radianceL *radiance) {
  __constant const parameters_t *scene = world.scene;
  const real tilt_x = scene->floor_roughness * (real)clamp(2 * jitter_x - 1, -1.0, 1.0),
             tilt_z = scene->floor_roughness * (real)clamp(2 * jitter_y - 1, -1.0, 1.0);
  const vec3L up = normalise(vec3(splat(tilt_x), splat(1), splat(tilt_z)));
  const vec3L onward = reflect3(ray->direction, dot3(ray->direction, up), up);
  const maskL heading = glossy & passes_stone(ray->origin, onward, splat(0));
  if (!any_lane(heading)) return heading;
  const crossingL entry = stone_entry(world, ray->origin, onward, splat(0), heading);
  const maskL enters = heading & entry.hit;
  const vec3L met = along(ray->origin, entry.t, onward);
  const realL height = blend(enters, fmax(met.y - ray->origin.y, splat(0)), splat(0));
  const realL share = blend(enters, scene->floor_reflectance * exp_fast(-height / scene->floor_fade), splat(0));
  EACH (k, 3) radiance->channel[k] *= 1 - share;
  ray->weight *= blend(enters, share, splat(1));
  ray->direction = blend3(enters, onward, ray->direction);
  *point = blend3(enters, met, *point);
  *normal = blend3(enters, entry.normal, *normal);
  return enters;
}

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets the stone.
static inline void see(world_t world, tile_t *tile, hits_t *hits, int column, int row, double jitter_x,
                       double jitter_y) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  const int has_backdrop = DECIDED(BACKDROP, world.scene->has_backdrop);
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
      radianceL radiance = black(), behind = black();
      if (has_backdrop) behind = backdrop_at(world.scene, column + x, row + y, jitter_x, jitter_y, all_channels());
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
        maskL glossy = none;
        const radianceL seen = gather(world, &ray, splat(1), BY_CAMERA, has_backdrop ? &behind : 0, &heading, &glossy,
                                      &cut, all_channels());
        EACH (k, 3) radiance.channel[k] += seen.channel[k];
        if (GEOMETRY != EMPTY && any_lane(glossy))
          meets |= mirrored_in_floor(world, &ray, glossy, jitter_x, jitter_y, &point, &normal, &radiance);
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
        enter(world, tile, pools, task, &packet, packet.origin, normal, mask, DECIDED(GLARE, world.scene->glare));
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
