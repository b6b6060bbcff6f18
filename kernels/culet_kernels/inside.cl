// Light inside a stone follows a chain: at each facet the transmitted part leaves, the reflected part goes on, until its weight
// is under the cut-off.
#ifndef CULET_INSIDE
#define CULET_INSIDE
#include "outside.cl"

// Segments of a chain between two looks at which of the packet's lanes have ended: a lane that idles for a segment costs
// less than sorting the packet each time.
#ifndef STRIDE
#define STRIDE 2
#endif

// Advances one packet of light inside a stone by a few segments, and puts back what survives.
static inline void advance(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  int shape;
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
    if (POLARISED || any_lane(leaves)) {
      const realL cos_a = sqrt(fmax(squared_a, (realL)0));
      const splitL parts = meet_boundary(world, &packet, crossing.normal, cos_a, cos_s, squared_a, eta);
#if RECORDED
      if (alive) tell_kept(world, packet.event, parts.kept);
#endif
      if (any_lane(leaves)) {
        polarisationL transmitted = parts.transmitted;
        if (POLARISED) transmitted.axis = turned_out(stone, transmitted.axis);
        leave(world, tile, pools, task, &packet, turned_out(stone, packet.origin),
              turned_out(stone, refract_outward(packet.direction, cos_a, cos_s, eta, crossing.normal)),
              (real)1 - parts.kept, transmitted, leaves);
      }
      scale_weights(&packet, parts.kept);
      packet.polarisation = parts.reflected;
    }
    packet.direction = reflect_inside(stone, packet.direction, cos_s, crossing.normal);
    packet.tag += ONE_BOUNCE;
    const maskL changed = POLARISED ? alive : ABSORPTION != 0 ? alive : leaves; // in weight
    const maskL used_up = !crossing.hit | widen((packet.tag >> BOUNCE_SHIFT) >= (intL)(world.scene->max_bounces));
    alive = settle(world, tile, task, &packet, INSIDE, alive, used_up, changed);
  }
  if (any_lane(alive)) push_to_shape(&pools->inside, shape, alive, &packet);
}

#endif
