// The estimator by chains: what a tile's pixels see without the stones, and then, by chains, in them.
//
// In a convex stone light follows a single chain. What leaves a stone may meet another, or be sent back by a mirror, and then
// starts another chain. All of it waits in pools of rays, so that packets are full.
//
// A work-item is at one tile at a time. It first finds where each pixel's ray meets a stone, then takes the chains one index
// of refraction after the other, or four neighbouring wavelengths at a time, one for each group of pixels.
#ifndef CULET_CHAIN
#define CULET_CHAIN
#include "camera.cl"
#include "hits.cl"
#include "inside.cl"

// Where lanes of a packet meet stones after all.
static inline void take_up(meetingL *met, maskL mask, meetingL other) {
  met->hit |= mask;
  met->point = blend3(mask, other.point, met->point);
  met->normal = blend3(mask, other.normal, met->normal);
#if STONES == MANY
  met->way = blend3(mask, other.way, met->way);
  met->stone = blend_ints_by(mask, other.stone, met->stone);
#endif
}

// Stones in a studio floor: of `glossy` rays, which end at the floor, those that a smooth floor would send to a stone.
// For them `ray` goes on there, with the floor's reflectance for its weight, and what they showed gives way to it. From
// sample to sample the floor is tilted a little, which softens what is seen far above it.
static inline maskL mirrored_in_floor(world_t world, rayL *ray, maskL glossy, const spotsL *spots, meetingL *met,
                                      radianceL *radiance) {
  __constant const parameters_t *scene = world.scene;
  const vec3L up =
      normalise(vec3(scene->floor_roughness * spots->tilt_x, splat(1), scene->floor_roughness * spots->tilt_z));
  const vec3L onward = reflect3(ray->direction, dot3(ray->direction, up), up);
  const maskL heading = glossy & passes_stones(world, ray->origin, onward, splat(0));
  if (!any_lane(heading)) return heading;
  const meetingL entry = stone_entry(world, ray->origin, onward, splat(0), heading, (intL)(NOBODY));
  const maskL enters = heading & entry.hit;
  const realL height = blend(enters, fmax(entry.t * onward.y, splat(0)), splat(0));
  const realL share = blend(enters, scene->floor_reflectance * exp_fast(-height / scene->floor_fade), splat(0));
  EACH (k, 3) radiance->channel[k] *= 1 - share;
#if RECORDED
  if (enters) scale_events(world, 0, 1 - share);
#endif
  ray->weight *= blend(enters, share, splat(1));
  ray->direction = blend3(enters, onward, ray->direction);
  take_up(met, enters, entry);
  return enters;
}

// The stones that a tile's rays may meet on their way from the camera.
typedef struct {
#if STONES == MANY
  uchar stone[MAX_STONES];
#endif
  int count;
} candidates_t;

static inline candidates_t candidates_of(world_t world, batch_t batch, int column, int row) {
  candidates_t found;
  found.count = 0;
#if STONES == MANY
  const int first_column = column >> batch.level, first_row = row >> batch.level, side = TILE >> batch.level;
  for (int number = 0; number < world.scene->stones; number++) {
    __constant const stone_t *stone = world.stones + number;
    const int across = stone->columns[0] < first_column + side && stone->columns[1] >= first_column,
              down = stone->rows[0] < first_row + side && stone->rows[1] >= first_row;
    if (across && down) found.stone[found.count++] = number;
  }
#endif
  return found;
}

// The stone that a ray from the camera enters first.
static inline meetingL first_seen(world_t world, const candidates_t *candidates, rayL ray, maskL mask) {
#if STONES == MANY
  meetingL first = nobody(ray.origin, ray.direction);
  for (int i = 0; i < candidates->count; i++)
    meet_stone(world, candidates->stone[i], ray.origin, ray.direction, ray.start, mask, (intL)(NOBODY), &first);
  return first;
#else
  return stone_entry(world, ray.origin, ray.direction, ray.start, mask, (intL)(NOBODY));
#endif
}

// A tile under way. All of it is kept where a launch ends before the tile does, and taken up by the next one.
typedef struct {
  tile_t tile;
  hits_t hits;
  pools_t pools;
  spectrum_t spectrum; // of the chain that is being followed
  int number;          // of the tile in the picture
  int packet;          // of its pixels, the first that was not looked at
  int chain;           // that is being followed, the first of a group of them
  int hit;             // the first whose chain has not begun
} chain_work_t;

// What each pixel of the tile sees without the stone, directly or by way of mirrors, and where its ray meets a stone.
static inline void see(world_t world, chain_work_t *work, batch_t batch, int column, int row, int *steps) {
  tile_t *tile = &work->tile;
  hits_t *hits = &work->hits;
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  const int has_backdrop = DECIDED(BACKDROP, world.scene->has_backdrop);
  const int columns = shown(batch, column, world.scene->width), rows = shown(batch, row, world.scene->height);
  const candidates_t candidates = candidates_of(world, batch, column, row);
  spotsL spots;
  int known = -1;
  for (; work->packet < PACKETS && *steps > 0; work->packet++) {
    const int x = work->packet % PACKETS_ACROSS * PACKET_WIDTH, y = work->packet / PACKETS_ACROSS * PACKET_HEIGHT;
    if (x >= columns || y >= rows) continue;
    --*steps;
    move_spots(&spots, batch, column + x, row + y, &known);
    const primaryL primary = primary_rays(world.scene, &spots);
    rayL ray = {primary.origin, primary.direction, primary.eye, splat(1), unpolarised(primary.direction)};
#if RECORDED
    ray.event = NOWHERE;
#endif
    const maskL all = in_picture(world.scene, &spots), none = all & !all;
    const int host = world.scene->camera_stone;
    meetingL met = from_inside(world, host, along(primary.origin, primary.eye, primary.direction), primary.direction);
    met.hit = camera_inside ? all : none;
    maskL open = camera_inside ? none : all;
    maskL heading = none;
    if (GEOMETRY == EMPTY ? 0 : STONES == ONE ? 1 : candidates.count > 0)
      heading = open & passes_stones(world, ray.origin, ray.direction, ray.start);
    bool direct = true;
    radianceL radiance = black(), behind = black();
    if (has_backdrop) behind = backdrop_at(world.scene, &spots, all_channels());
    realL cut = splat(0);
    while (any_lane(open)) {
      if (any_lane(heading)) {
        const meetingL entry = direct
                                   ? first_seen(world, &candidates, ray, heading)
                                   : stone_entry(world, ray.origin, ray.direction, ray.start, heading, (intL)(NOBODY));
        const maskL enters = heading & entry.hit & !hidden_by_room(world, ray, entry.t);
        take_up(&met, enters, entry);
        open &= !enters;
      }
      direct = false;
      heading = open;
      maskL glossy = none;
      const radianceL seen =
          gather(world, &ray, splat(1), BY_CAMERA, has_backdrop ? &behind : 0, &heading, &glossy, &cut, all_channels());
      EACH (k, 3) radiance.channel[k] += seen.channel[k];
      if (GEOMETRY != EMPTY && world.scene->stones > 0 && any_lane(glossy))
        mirrored_in_floor(world, &ray, glossy, &spots, &met, &radiance);
      open = heading;
    }
    const int first = first_pixel(x, y);
    EACH (k, 3) begin_sums(radiance.channel[k], tile->radiance[k] + first);
    store_lanes(3 * cut, tile->cut + first);
    const intL tag = first + LANE_INDEX + (groups_of(&spots, world.scene->sample) << PIXEL_BITS);
    if (any_lane(met.hit)) note(world, hits, met, ray, tag);
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
    const bool last = all_begun && is_dark_inside(pools);
    const bool over = last && is_clear(pools); // packets are not filled any more
    // Light outside goes first: it is what makes the pools grow.
    pool_t *left = larger_away(pools);
    if (left->count >= (over ? 1 : LANES))
      look_away(world, tile, pools, left, task);
    else if (look_outside(world, tile, pools, task, last))
      continue;
    else if (has_full(&pools->inside) || (all_begun && !last))
      advance(world, tile, pools, task, all_begun && !has_full(&pools->inside));
    else if (!all_begun) {
      const maskL mask = widen(LANE_INDEX < (intL)(hits->count - work->hit));
      vec3L normal;
      const packetL packet = hits_at(hits, work->hit, &normal);
      if (camera_inside)
        push_inside(world, &pools->inside, mask, &packet);
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
  clear_pools(&work->pools);
}

// Goes on with a tile for as many steps as are left, each of which takes some tenths of a microsecond to some
// microseconds; returns whether the tile is done.
static inline bool advance_chain_tile(world_t world, chain_work_t *work, batch_t batch, int column, int row,
                                      int *steps) {
  __constant const parameters_t *scene = world.scene;
  see(world, work, batch, column, row, steps);
  if (work->packet < PACKETS) return false;
  if (GEOMETRY == EMPTY || work->hits.count == 0) return true;
  fill(&work->hits);
  while (work->chain < scene->chains) {
    const uint seed = (((uint)scene->sample * 256 + work->chain) * 8191 + row / TILE) * 8191 + column / TILE;
    const task_t task = task_of(world, batch.level, work->chain, seed, &work->spectrum);
    trace(world, work, task, steps);
    if (*steps <= 0) return false;
    work->chain += GROUPS;
    work->hit = 0;
  }
  return true;
}

#endif
