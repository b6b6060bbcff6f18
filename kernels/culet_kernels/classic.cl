// The report's own estimator, for comparison: one path for each channel, a fixed number of meetings, no partial reflection
// inside the stone.
//
// At the stone's surface Schlick's term with the cosine of incidence, on both sides, adds the sky in the mirrored
// direction as if nothing were in the way; what can be refracted is, and only total reflection stays inside.
// Absorption counts the last segment, where light leaves. Where meetings run out, the sky in the mirrored direction takes
// the place of what is missing.
#ifndef CULET_CLASSIC
#define CULET_CLASSIC
#include "camera.cl"
#include "fresnel.cl"
#include "room.cl"
#include "tile.cl"

// A packet's paths of one channel, between two meetings.
typedef struct {
  rayL ray;
  realL radiance;
  maskL active, inside;
  int meetings; // that were had
} classic_path_t;

// A tile under way. All of it is kept where a launch ends before the tile does, and taken up by the next one.
typedef struct {
  tile_t tile;
  classic_path_t path; // of the packet and channel that it is at
  int number;          // of the tile in the picture
  int packet;          // of its pixels
  int channel;
} classic_work_t;

static inline void begin_path(world_t world, classic_path_t *path, primaryL primary, maskL active) {
  const maskL all = splat(0) < splat(1), none = !all;
  const rayL ray = {primary.origin, primary.direction, primary.eye, splat(1), unpolarised(primary.direction)};
  path->ray = ray;
  path->inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside) ? all : none;
  if (any_lane(path->inside)) path->ray.origin = along(primary.origin, primary.eye, primary.direction);
  path->radiance = splat(0);
  path->active = active;
  path->meetings = 0;
}

// Goes on for as many meetings as steps are left; returns whether the paths have ended.
static inline bool advance_path(world_t world, classic_path_t *path, int channel, const radianceL *backdrop,
                                intL *segments, int *steps) {
  __constant const parameters_t *scene = world.scene;
  const channels_t channels = {channel, 1};
  const real eta = world.chains[channel].eta;
  const maskL all = splat(0) < splat(1), none = !all;
  rayL ray = path->ray;
  realL radiance = path->radiance;
  maskL active = path->active, inside = path->inside;
  int meeting = path->meetings;
  for (; meeting < scene->max_bounces && any_lane(active) && *steps > 0; meeting++, --*steps) {
    const maskL last = (maskL)(meeting == scene->max_bounces - 1 ? -1 : 0) & all;

    // The nearest of stone and room.
    maskL at_stone = none;
    realL t = splat(0);
    vec3L normal = ray.direction; // outward
    if (GEOMETRY != EMPTY) {
      const maskL heading = active & !inside & passes_stones(world, ray.origin, ray.direction, ray.start);
      if (any_lane(heading)) {
        const meetingL entry = stone_entry(world, ray.origin, ray.direction, ray.start, heading, (intL)(NOBODY));
        at_stone = heading & entry.hit & !hidden_by_room(world, ray, entry.t);
        t = blend(at_stone, entry.t, t);
        normal = blend3(at_stone, entry.normal, normal);
      }
      const maskL leaving = active & inside;
      if (any_lane(leaving)) {
        const crossingL exit = stone_exit(world, world.stones, ray.origin, ray.direction, leaving);
        *segments += count_mask(leaving);
        const maskL found = leaving & exit.hit;
        t = blend(found, exit.t, t);
        normal = blend3(found, exit.normal, normal);
        at_stone |= found;
        active &= !(leaving & !exit.hit);
      }
    }
    const maskL in_room = active & !at_stone;
    const viewL view =
        look(world, ray, in_room, meeting == 0 ? BY_CAMERA : BY_STONE, meeting == 0 ? backdrop : 0, channels);
    const radianceL fallback =
        sky(world, reflect3(ray.direction, dot3(ray.direction, view.normal), view.normal), channels);
    const maskL faces_room = in_room & view.meets;
    const realL seen = blend(faces_room & last, fallback.channel[0], view.radiance.channel[0]);
    radiance += blend(in_room, ray.weight * seen, splat(0));
    const maskL mirrored = in_room & view.reflects & !last;

    // At the stone.
    const vec3L point = along(ray.origin, t, ray.direction);
    const realL cosine = dot3(ray.direction, normal); // negative from outside
    const vec3L reflected = reflect3(ray.direction, cosine, normal);
    const radianceL mirrored_sky = sky(world, reflected, channels);
    const realL term = fresnel_schlick(fabs(cosine), eta);
    const realL ratio = blend(inside, splat(eta), splat(1 / eta));
    const realL squared = (real)1 - ratio * ratio * ((real)1 - cosine * cosine);
    const maskL refracted = at_stone & (squared >= 0) & !last, total = at_stone & !refracted & !last;
    const maskL shows = at_stone & (inside | widen((intL)(DECIDED(GLARE, scene->glare) || meeting > 0 ? -1 : 0)));
    radiance += blend(shows, ray.weight * mirrored_sky.channel[0] * blend(last, splat(1), term), splat(0));
    const realL bend = blend(inside, sqrt(fmax(squared, splat(0))), -sqrt(fmax(squared, splat(0)))) - ratio * cosine;
    const vec3L bent =
        renormalise(vec3(fma(ratio, ray.direction.x, bend * normal.x), fma(ratio, ray.direction.y, bend * normal.y),
                         fma(ratio, ray.direction.z, bend * normal.z)));
    if (ABSORPTION != 0)
      ray.weight *= blend(refracted & inside, exp_fast(-world.chains[channel].absorption * t), splat(1));
    ray.weight *= blend(refracted, (real)1 - term, blend(mirrored, splat(MIRROR_REFLECTANCE), splat(1)));

    const maskL goes_on = refracted | total | mirrored;
    ray.origin = blend3(mirrored, view.point, blend3(at_stone, point, ray.origin));
    ray.direction = blend3(mirrored, reflect3(ray.direction, dot3(ray.direction, view.normal), view.normal),
                           blend3(refracted, bent, blend3(total, reflected, ray.direction)));
    ray.start = blend(goes_on, splat(0), ray.start);
    inside = (inside & !refracted) | (refracted & !inside);
    active &= goes_on;
  }
  path->ray = ray;
  path->radiance = radiance;
  path->active = active;
  path->inside = inside;
  path->meetings = meeting;
  return meeting >= scene->max_bounces || !any_lane(active);
}

static inline void begin_classic_tile(classic_work_t *work, int number) {
  work->number = number;
  work->packet = work->channel = work->path.meetings = 0;
  work->tile.segments = (intL)(0);
}

// Goes on with a tile for as many steps as are left, each of them a packet's meeting; returns whether the tile is done.
static inline bool advance_classic_tile(world_t world, classic_work_t *work, batch_t batch, int column, int row,
                                        int *steps) {
  __constant const parameters_t *scene = world.scene;
  tile_t *tile = &work->tile;
  const int columns = shown(batch, column, scene->width), rows = shown(batch, row, scene->height);
  spotsL spots;
  int known = -1;
  for (; work->packet < PACKETS; work->packet++, work->channel = 0) {
    const int x = work->packet % PACKETS_ACROSS * PACKET_WIDTH, y = work->packet / PACKETS_ACROSS * PACKET_HEIGHT;
    if (x >= columns || y >= rows) continue;
    const int first = first_pixel(x, y);
    move_spots(&spots, batch, column + x, row + y, &known);
    for (; work->channel < 3; work->channel++, work->path.meetings = 0) {
      if (work->path.meetings == 0)
        begin_path(world, &work->path, primary_rays(scene, &spots), in_picture(scene, &spots));
      const channels_t channels = {work->channel, 1};
      const radianceL behind = backdrop_at(scene, &spots, channels);
      if (!advance_path(world, &work->path, work->channel, DECIDED(BACKDROP, scene->has_backdrop) ? &behind : 0,
                        &tile->segments, steps))
        return false;
      begin_sums(work->path.radiance, tile->radiance[work->channel] + first);
    }
    store_lanes(splat(0), tile->cut + first);
  }
  return true;
}

#endif
