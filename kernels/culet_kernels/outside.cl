// Light outside the stones: what leaves one waits by what it may meet, and is followed in full packets.
#ifndef CULET_OUTSIDE
#define CULET_OUTSIDE
#include "boundary.cl"
#include "pool.cl"
#include "room.cl"
#include "sink.cl"

typedef struct {
  inside_t inside;
#if WAITS_AT_FACETS
  at_facets_t at_facets; // come to from inside
#endif
#if STONES == MANY
  pool_t leaving;                  // stones, still in the axes of light inside
  int near[NEAR_WORDS][POOL_SIZE]; // which stones those of `towards` may meet
#endif
  pool_t towards;                  // may meet a stone
  pool_t away;                     // can meet the room and the sky only, by way of mirrors a stone again
  pool_t up;                       // can meet the sky only
} pools_t;

static inline void clear_pools(pools_t *pools) {
  clear_inside(&pools->inside);
#if WAITS_AT_FACETS
  pools->at_facets.count = 0;
#endif
#if STONES == MANY
  clear(&pools->leaving);
#endif
  clear(&pools->towards);
  clear(&pools->away);
  clear(&pools->up);
}

// Whether no light waits outside the stones but what meets none of them.
static inline int is_clear(const pools_t *pools) {
#if STONES == MANY
  if (pools->leaving.count > 0) return 0;
#endif
  return REENTRY ? pools->towards.count == 0 : 1;
}

// Whether no light is inside a stone, or waits at a facet of one.
static inline int is_dark_inside(const pools_t *pools) {
#if WAITS_AT_FACETS
  if (pools->at_facets.count > 0) return 0;
#endif
  return is_empty(&pools->inside);
}

// Puts off a packet that meets no stone next. Where there is a floor and no wall, what goes up and what goes down wait apart, so
// that a packet does not look at both.
static inline void put_away(world_t world, pools_t *pools, maskL mask, const packetL *packet) {
  const int floor_kind = DECIDED(FLOOR, world.scene->floor_kind), walls_kind = DECIDED(WALLS, world.scene->walls_kind);
  const int parted = floor_kind == NONE ? 0 : walls_kind == NONE;
  const maskL up = packet->direction.y >= -HORIZON;
  if (parted) push(&pools->up, mask & up, packet);
  push(&pools->away, parted ? mask & !up : mask, packet);
}

#if STONES != MANY
typedef int nearL; // there is one
#endif

// Puts off a packet that may meet a stone. What finds no room is counted as cut.
static inline void put_off(world_t world, tile_t *tile, pools_t *pools, task_t task, maskL mask, const packetL *packet,
                           const nearL *near) {
  if (has_room(&pools->towards)) {
#if STONES == MANY
    EACH (k, NEAR_WORDS) pack_ints(packing_of(mask), near->word[k], pools->near[k] + pools->towards.count);
#endif
    push(&pools->towards, mask, packet);
  } else {
#if RECORDED
    if (mask) tell_end(world, task, packet, ABROAD, black());
#endif
    lose(tile, mask, packet, over_channels(task, packet));
  }
}

// Puts off a packet that is outside the stones, by what it may meet.
static inline void let_go(world_t world, tile_t *tile, pools_t *pools, task_t task, maskL mask, const packetL *packet) {
#if STONES == MANY
  const nearL near = near_stones(world, packet->origin, packet->direction, splat(0), packet->stone);
  const maskL towards = mask & any_near(&near);
  if (any_lane(towards)) put_off(world, tile, pools, task, towards, packet, &near);
  put_away(world, pools, mask & !towards, packet);
#else
  if (EXCHANGE)
    put_off(world, tile, pools, task, mask, packet, 0);
  else
    put_away(world, pools, mask, packet);
#endif
}

// Lets go what leaves a stone, or what it reflects, at this point of the frame, in the frame's axes. Of MANY it is as `packet` is, in
// the axes of light inside: since stones differ by lane, it waits to be turned into the frame in a full packet.
static inline void leave(world_t world, tile_t *tile, pools_t *pools, task_t task, const packetL *packet, vec3L point,
                         vec3L direction, realL share, polarisationL polarisation, maskL mask) {
  packetL outer = *packet;
  outer.direction = direction;
  outer.polarisation = polarisation;
  scale_weights(&outer, share);
#if STONES == MANY
  push(&pools->leaving, mask, &outer);
#else
  outer.origin = point;
  let_go(world, tile, pools, task, mask, &outer);
#endif
}

// Splits light that meets a stone from outside, at the origin of the packet, which is this point of the frame: what is reflected goes into the room, if
// `glare` says so, and what enters starts a chain. Of MANY it is part of both its callers: by itself it would get packets by way of memory.
#if STONES == MANY
__attribute__((always_inline))
#endif
static inline void enter(world_t world, tile_t *tile, pools_t *pools, task_t task, const packetL *packet, vec3L point,
                         vec3L normal, maskL mask, bool glare) {
  const realL cos_a = clamp(-dot3(packet->direction, normal), (realL)0, (realL)1);
  const chainL eta = eta_of(world, task, packet);
  const realL cos_s = cosine_in_stone(cos_a, eta);
  const splitL parts = meet_boundary(world, packet, normal, cos_a, cos_s, fmax(cos_a * cos_a, splat((real)1e-30)), eta);
#if RECORDED
  packetL told = *packet;
  if (mask) told.event = tell_entry(world, task, packet, normal, parts.kept, glare);
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
  const maskL goes_on = settle(world, tile, task, &inner, ENTERING, mask, mask & !mask, mask);
  if (has_room_inside(&pools->inside))
    push_inside(world, &pools->inside, goes_on, &inner);
  else {
#if RECORDED
    if (goes_on) tell_end(world, task, &inner, ENTERING, black());
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
#if STONES == MANY
    const nearL near = near_stones(world, packet.origin, packet.direction, splat(0), packet.stone);
    put_off(world, tile, pools, task, towards, &packet, &near);
#else
    put_off(world, tile, pools, task, towards, &packet, 0);
#endif
  }
}

#if STONES == MANY
// Takes one packet of what leaves stones, into the frame.
static inline void turn_out(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  packetL packet = pop(&pools->leaving, &taken);
  const axesL axes = inner_axes_of(world, packet.stone);
  packet.origin = to_frame(world, packet.stone, out_of_axes_of(axes, packet.origin));
  packet.direction = out_of_axes_of(axes, packet.direction);
  if (POLARISED) packet.polarisation.axis = out_of_axes_of(axes, packet.polarisation.axis);
  let_go(world, tile, pools, task, taken, &packet);
}
#endif

// Takes one packet that may meet a stone: it enters, or goes on through the room.
static inline void look_around(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  packetL packet = pop(&pools->towards, &taken);
#if STONES == MANY
  nearL near;
  EACH (k, NEAR_WORDS) near.word[k] = load_ints(pools->near[k] + pools->towards.count);
  meetingL met = nobody(packet.origin, packet.direction);
  for (maskL asking = taken; any_lane(asking);) {
    meet_next(world, &near, packet.origin, packet.direction, splat(0), asking, packet.stone, &met);
    asking &= any_near(&near);
    const maskL waits = asking & !met.hit;
    if (any_lane(waits)) put_off(world, tile, pools, task, waits, &packet, &near); // for a full packet
    taken &= !waits;
    asking &= met.hit;
  }
#else
  meetingL met = stone_entry(world, packet.origin, packet.direction, splat(0), taken, packet.stone);
#endif
  const rayL ray = {packet.origin, packet.direction, splat(0), splat(1), packet.polarisation};
  const maskL meets = met.hit & !hidden_by_room(world, ray, met.t);
  const maskL misses = taken & !meets;
  if (any_lane(misses)) put_away(world, pools, misses, &packet);
  // Between stones that overlap light could be reflected for ever; so only what is worth it meets another one.
  maskL hits = taken & meets;
  if (STONES == MANY) hits = settle(world, tile, task, &packet, ABROAD, hits, misses & !misses, hits);
  if (any_lane(hits)) {
    const vec3L point = along(packet.origin, met.t, packet.direction);
    met.stone = blend_ints_by(hits, met.stone, (intL)(0)); // no lane names a stone that is not there
    bring(world, &packet, met);
    enter(world, tile, pools, task, &packet, point, met.normal, hits, true);
  }
}

// Takes a packet of light outside that may meet a stone, if there is a full one, or the `last` ones; returns whether it did.
static inline bool look_outside(world_t world, tile_t *tile, pools_t *pools, task_t task, bool last) {
  const int enough = last ? 1 : LANES;
#if STONES == MANY
  if (pools->leaving.count >= enough) {
    turn_out(world, tile, pools, task);
    return true;
  }
#endif
  if (REENTRY ? pools->towards.count < enough : 1) return false;
  look_around(world, tile, pools, task);
  return true;
}

#endif
