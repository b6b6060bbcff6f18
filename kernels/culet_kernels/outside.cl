// Light outside the stones: what leaves one waits by what it may meet, and is followed in full packets.
#ifndef CULET_OUTSIDE
#define CULET_OUTSIDE
#include "boundary.cl"
#include "pool.cl"
#include "room.cl"
#include "sink.cl"

typedef struct {
  inside_t inside;
  pool_t towards; // may meet a stone
  pool_t away;    // can meet the room and the sky only, by way of mirrors a stone again
  pool_t up;      // can meet the sky only
} pools_t;

// Puts off a packet that meets no stone next. Where there is a floor and no wall, what goes up and what goes down wait apart, so
// that a packet does not look at both.
static inline void put_away(world_t world, pools_t *pools, maskL mask, const packetL *packet) {
  const int floor_kind = DECIDED(FLOOR, world.scene->floor_kind), walls_kind = DECIDED(WALLS, world.scene->walls_kind);
  const int parted = floor_kind == NONE ? 0 : walls_kind == NONE;
  const maskL up = packet->direction.y >= -HORIZON;
  if (parted) push(&pools->up, mask & up, packet);
  push(&pools->away, parted ? mask & !up : mask, packet);
}

// Puts off a packet that may meet a stone. What finds no room is counted as cut.
static inline void put_off(world_t world, tile_t *tile, pools_t *pools, task_t task, maskL mask,
                           const packetL *packet) {
  if (has_room(&pools->towards))
    push(&pools->towards, mask, packet);
  else {
#if RECORDED
    if (mask) tell_end(world, task, packet, 0, black());
#endif
    lose(tile, mask, packet, over_channels(task, packet));
  }
}

// Lets go what leaves a stone's surface at a point of the frame, reflected or from inside. `packet` is as it meets the surface.
static inline void leave(world_t world, tile_t *tile, pools_t *pools, task_t task, const packetL *packet, vec3L point,
                         vec3L direction, realL share, polarisationL polarisation, maskL mask) {
  packetL outer = *packet;
  outer.origin = point;
  outer.direction = direction;
  outer.polarisation = polarisation;
  scale_weights(&outer, share);
  if (EXCHANGE)
    put_off(world, tile, pools, task, mask, &outer);
  else
    put_away(world, pools, mask, &outer);
}

#if STONES == MANY
// The index of each lane's stone.
static inline chainL eta_of_each(world_t world, task_t task, const packetL *packet) {
  int number[LANES], tag[LANES];
  real eta[LANES];
  store_ints(packet->stone, number);
  store_ints(packet->tag, tag);
  for (int lane = 0; lane < LANES; lane++)
    eta[lane] = task.chains[world.stones[number[lane]].first_chain + (tag[lane] >> PIXEL_BITS & (GROUPS - 1))].eta;
  return load_lanes(eta);
}
#else
static inline chainL eta_of_each(world_t world, task_t task, const packetL *packet) {
  return OF_CHAIN(task, packet->tag, eta);
}
#endif

// Splits light that meets a stone from outside, at the origin of the packet, which is this point of the frame: what is reflected goes into the room, if
// `glare` says so, and what enters starts a chain.
static inline void enter(world_t world, tile_t *tile, pools_t *pools, task_t task, const packetL *packet, vec3L point,
                         vec3L normal, maskL mask, bool glare) {
  const realL cos_a = clamp(-dot3(packet->direction, normal), (realL)0, (realL)1);
  const chainL eta = eta_of_each(world, task, packet);
  const realL cos_s = cosine_in_stone(cos_a, eta);
  const splitL parts = meet_boundary(world, packet, normal, cos_a, cos_s, fmax(cos_a * cos_a, splat((real)1e-30)), eta);
#if RECORDED
  packetL told = *packet;
  if (mask) told.event = tell_entry(world, task, packet, point, normal, parts.kept, glare);
  packet = &told;
#endif
  if (glare)
    leave(world, tile, pools, task, packet, point, reflect3(packet->direction, -cos_a, normal), parts.kept,
          parts.reflected, mask);
  packetL inner = *packet;
  inner.direction = refract_inward(packet->direction, cos_a, cos_s, eta, normal);
  inner.polarisation = parts.transmitted;
  scale_weights(&inner, (real)1 - parts.kept);
  inner.tag = packet->tag & (ONE_BOUNCE - 1);
  const maskL goes_on = settle(world, tile, task, &inner, 0, mask, mask & !mask);
  if (has_room_inside(&pools->inside))
    push_inside(world, &pools->inside, goes_on, &inner);
  else {
#if RECORDED
    if (goes_on) tell_end(world, task, &inner, 0, black());
#endif
    lose(tile, goes_on, &inner, over_channels(task, &inner));
  }
}

// The larger of the pools of what meets no stone next.
static inline pool_t *larger_away(pools_t *pools) {
  return pools->away.count >= pools->up.count ? &pools->away : &pools->up;
}

// Takes one packet of these pools, and shows what it sees. What a mirror sends towards a stone goes on.
static inline void look_away(world_t world, tile_t *tile, pools_t *pools, pool_t *from, task_t task) {
  maskL taken;
  packetL packet = pop(from, &taken);
  rayL ray = {packet.origin, packet.direction, splat(0), splat(1), packet.polarisation};
#if RECORDED
  ray.event = packet.event;
  const int first = world.record->count;
#endif
  maskL towards = taken;
  realL cut = splat(0);
  const radianceL radiance =
      gather(world, &ray, largest_weight(&packet), BY_STONE, 0, &towards, 0, &cut, channels_of(task));
#if RECORDED
  weigh_events(world, first, task, &packet);
#endif
  show(tile, task, taken, &packet, radiance);
  lose(tile, taken & (cut > 0), &packet, cut * over_channels(task, &packet));
  if (REENTRY && any_lane(towards)) {
    packet.origin = ray.origin;
    packet.direction = ray.direction;
    packet.polarisation = ray.polarisation;
#if RECORDED
    packet.event = ray.event;
#endif
    packet.stone = (intL)(NOBODY);
    scale_weights(&packet, ray.weight);
    put_off(world, tile, pools, task, towards, &packet);
  }
}

// Takes one packet that may meet a stone: it enters, or goes on through the room.
static inline void look_around(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  packetL packet = pop(&pools->towards, &taken);
  const meetingL met = stone_entry(world, packet.origin, packet.direction, splat(0), taken, packet.stone);
  const rayL ray = {packet.origin, packet.direction, splat(0), splat(1), packet.polarisation};
  const maskL meets = met.hit & !hidden_by_room(world, ray, met.t);
  const maskL misses = taken & !meets;
  if (any_lane(misses)) put_away(world, pools, misses, &packet);
  // Between stones that overlap light could be reflected for ever; so only what is worth it meets another one.
  maskL hits = taken & meets;
  if (STONES == MANY) hits = settle(world, tile, task, &packet, 0, hits, misses & !misses);
  if (any_lane(hits)) {
    const vec3L point = along(packet.origin, met.t, packet.direction);
    packet.origin = met.point;
    if (STONES == MANY)
      packet.stone = blend_ints_by(hits, met.stone, (intL)(0)); // no lane names a stone that is not there
    enter(world, tile, pools, task, &packet, point, met.normal, hits, true);
  }
}

#endif
