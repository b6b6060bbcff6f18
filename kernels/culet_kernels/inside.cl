// Light inside a stone follows a chain: at each facet the transmitted part leaves, the reflected part goes on, until its weight
// is under the cut-off.
#ifndef CULET_INSIDE
#define CULET_INSIDE
#include "outside.cl"

// Splits a packet of light that has come to facets from inside: what goes through leaves, and the packet has what stays inside for its weight.
__attribute__((always_inline)) static inline void
part_at_facet(world_t world, tile_t *tile, pools_t *pools, task_t task, __constant const stone_t *stone,
              packetL *packet, vec3L normal, realL cos_s, realL squared_a, chainL eta, maskL alive, maskL leaves) {
  const realL cos_a = sqrt(fmax(squared_a, (realL)0));
  const splitL parts = meet_boundary(world, packet, normal, cos_a, cos_s, squared_a, eta);
#if RECORDED
  if (alive) tell_kept(world, packet->event, parts.kept);
#endif
  if (any_lane(leaves)) {
    polarisationL transmitted = parts.transmitted;
    if (POLARISED) transmitted.axis = turned_out(stone, transmitted.axis);
    leave(world, tile, pools, task, packet, turned_out(stone, packet->origin),
          turned_out(stone, refract_outward(packet->direction, cos_a, cos_s, eta, normal)), (real)1 - parts.kept,
          transmitted, leaves);
  }
  scale_weights(packet, parts.kept);
  packet->polarisation = parts.reflected;
}

// Reflects a packet at facets that it has come to from inside; returns what goes on.
__attribute__((always_inline)) static inline maskL go_on(world_t world, tile_t *tile, task_t task,
                                                         __constant const stone_t *stone, packetL *packet, vec3L normal,
                                                         realL cos_s, maskL alive, maskL missed, maskL changed) {
  packet->direction = reflect_inside(stone, packet->direction, cos_s, normal);
  packet->tag += ONE_BOUNCE;
  const maskL used_up = missed | widen((packet->tag >> BOUNCE_SHIFT) >= (intL)(world.scene->max_bounces));
  return settle(world, tile, task, packet, INSIDE, alive, used_up, changed);
}

#if WAITS_AT_FACETS
// Splits and reflects a packet of the light that waits at facets, and puts back inside what survives.
__attribute__((always_inline)) static inline void leave_facets(world_t world, tile_t *tile, pools_t *pools,
                                                               task_t task) {
  maskL taken;
  vec3L normal;
  packetL packet = take_waiting(&pools->at_facets, &taken, &normal);
  __constant const stone_t *stone = world.stones; // any of its shape
  const chainL eta = eta_of(world, task, &packet);
  const realL cos_s = clamp(dot3(packet.direction, normal), (realL)0, (realL)1);
  const realL squared_a = squared_cosine_in_air(cos_s, eta);
  part_at_facet(world, tile, pools, task, stone, &packet, normal, cos_s, squared_a, eta, taken, taken);
  const maskL alive = go_on(world, tile, task, stone, &packet, normal, cos_s, taken, taken & !taken, taken);
  if (any_lane(alive)) push_to_shape(&pools->inside, 0, alive, &packet);
}
#endif

// Advances one packet of light inside a stone by a few segments, and puts back what survives. What leaves in
// part may wait for a full packet, which is not waited for where light inside is `scarce`.
static inline void advance(world_t world, tile_t *tile, pools_t *pools, task_t task, bool scarce) {
  int shape;
#if WAITS_AT_FACETS
  if (scarce && pools->at_facets.count > 0) {
    leave_facets(world, tile, pools, task);
    return;
  }
#endif
  maskL taken;
  packetL packet = pop_inside(&pools->inside, &taken, &shape);
  __constant const stone_t *stone = world.stones + shape;
  const chainL eta = eta_of(world, task, &packet);
  maskL alive = taken;
  for (int segment = 0; segment < STRIDE && any_lane(alive); segment++) {
    const crossingL crossing = inner_exit(world, stone, packet.origin, packet.direction, alive);
    tile->segments += count_mask(alive);
    packet.origin = along(packet.origin, crossing.t, packet.direction);
#if RECORDED
    const real before = packet.weight[0];
#endif
    if (ABSORPTION != 0) {
      EACH (k, WEIGHTS) packet.weight[k] *= exp_fast(-absorption_of(world, task, &packet, k) * crossing.t);
    }
    const realL cos_s = clamp(dot3(packet.direction, crossing.normal), (realL)0, (realL)1);
    const realL squared_a = squared_cosine_in_air(cos_s, eta);
    const maskL leaves = alive & (squared_a > 0);
#if RECORDED
    if (alive) packet.event = tell_meeting(world, task, &packet, before, crossing.t, crossing.normal);
#endif
#if WAITS_AT_FACETS
    const maskL waits = leaves & crossing.hit;
    if (any_lane(waits)) wait_at_facet(&pools->at_facets, waits, &packet, crossing.normal);
    alive &= !waits;
#else
    if (POLARISED || any_lane(leaves))
      part_at_facet(world, tile, pools, task, stone, &packet, crossing.normal, cos_s, squared_a, eta, alive, leaves);
#endif
    const maskL changed = POLARISED ? alive : ABSORPTION != 0 ? alive : leaves; // in weight
    alive = go_on(world, tile, task, stone, &packet, crossing.normal, cos_s, alive, !crossing.hit, changed);
  }
  if (any_lane(alive)) push_to_shape(&pools->inside, shape, alive, &packet);
#if WAITS_AT_FACETS
  while (pools->at_facets.count >= LANES) leave_facets(world, tile, pools, task);
#endif
}

#endif
