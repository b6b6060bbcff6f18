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

// A tile under way. All of it is kept where a launch ends before the tile does, and taken up by the next one.
typedef struct {
  tile_t tile;
  hits_t hits;
  pools_t pools;
  int number; // of the tile in the picture
  int packet; // of its pixels, the first that was not looked at
  int chain;  // that is being followed, the first of a group of them
  int hit;    // the first whose chain has not begun
} chain_work_t;

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets the stone.
static inline void see(world_t world, chain_work_t *work, int column, int row, double jitter_x, double jitter_y,
                       int *steps) {
  tile_t *tile = &work->tile;
  hits_t *hits = &work->hits;
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  const int has_backdrop = DECIDED(BACKDROP, world.scene->has_backdrop);
  const int columns = shown(column, world.scene->width), rows = shown(row, world.scene->height);
  for (; work->packet < PACKETS && *steps > 0; work->packet++) {
    const int x = work->packet % PACKETS_ACROSS * PACKET_WIDTH, y = work->packet / PACKETS_ACROSS * PACKET_HEIGHT;
    if (x >= columns || y >= rows) continue;
    --*steps;
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
      const radianceL seen =
          gather(world, &ray, splat(1), BY_CAMERA, has_backdrop ? &behind : 0, &heading, &glossy, &cut, all_channels());
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
}

// Follows the light of all first hits along one chain each, to its end or as far as the steps reach.
static inline void trace(world_t world, chain_work_t *work, task_t task, int *steps) {
  tile_t *tile = &work->tile;
  pools_t *pools = &work->pools;
  const hits_t *hits = &work->hits;
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  for (; *steps > 0; --*steps) {
    const bool all_begun = work->hit >= hits->count;
    // Light that has come back goes first: it is what makes the pools grow.
    if (REENTRY &&
        (pools->outside.count >= LANES || (all_begun && pools->inside.count == 0 && pools->outside.count > 0)))
      come_back(world, tile, pools, task);
    else if (pools->inside.count >= LANES || (all_begun && pools->inside.count > 0))
      advance(world, tile, pools, task);
    else if (!all_begun) {
      const maskL mask = widen(LANE_INDEX < (intL)(hits->count - work->hit));
      vec3L normal;
      packetL packet = hits_at(hits, work->hit, &normal);
      if (camera_inside)
        push(&pools->inside, mask, &packet);
      else
        enter(world, tile, pools, task, &packet, packet.origin, normal, mask, DECIDED(GLARE, world.scene->glare));
      work->hit += LANES;
    } else
      return;
  }
}

static inline void begin_chain_tile(chain_work_t *work, int number) {
  work->number = number;
  work->packet = work->chain = work->hit = 0;
  work->tile.segments = (intL)(0);
  work->hits.count = 0;
  clear(&work->pools.inside);
  clear(&work->pools.outside);
}

// Goes on with a tile for as many steps as are left, each of which takes some tenths of a microsecond to some
// microseconds; returns whether the tile is done.
static inline bool advance_chain_tile(world_t world, chain_work_t *work, int column, int row, double jitter_x,
                                      double jitter_y, int *steps) {
  __constant const parameters_t *scene = world.scene;
  see(world, work, column, row, jitter_x, jitter_y, steps);
  if (work->packet < PACKETS) return false;
  if (GEOMETRY == EMPTY || work->hits.count == 0) return true;
  fill(&work->hits);
  while (work->chain < scene->chains) {
    const uint seed = (((uint)scene->sample * 256 + work->chain) * 8191 + row / TILE) * 8191 + column / TILE;
    const task_t task = {world.chains + work->chain, CHANNELS == 3 ? 0 : work->chain, seed * 0x9e3779b9u};
    trace(world, work, task, steps);
    if (*steps <= 0) return false;
    work->chain += GROUPS;
    work->hit = 0;
  }
  return true;
}

#endif
