// The light of one tile of pixels, by chains.
//
// In a convex stone light follows a single chain: at each facet the transmitted part leaves, the reflected part goes on,
// until its weight is under the cut-off. What leaves is followed through the room at once; a mirror may send it back to
// the stone, where it starts another chain. All of it waits in pools of rays, so that packets are full.
//
// A work-item owns a tile. It first finds where each pixel's ray meets the stone, then takes the chains one index of
// refraction after the other: within a packet, everything that depends on the wavelength is the same.
#ifndef CULET_TRACE
#define CULET_TRACE
#include "camera.cl"
#include "fresnel.cl"
#include "pool.cl"
#include "room.cl"
#include "tile.cl"

// Segments of a chain between two looks at which of the packet's lanes have ended: a lane that idles for a segment costs
// less than sorting the packet each time.
#ifndef STRIDE
#define STRIDE 2
#endif

// Where pixels' rays first meet the stone.
#define HITS (TILE_PIXELS + LANES) // a packet is written whole, and counted as far as it is meant
typedef struct {
  real point[3][HITS], direction[3][HITS], normal[3][HITS];
  real weight[HITS];
  int pixel[HITS];
  int count;
} hits_t;

typedef struct {
  pool_t inside, outside;
} pools_t;

// One chain's share of the picture: its index, and the channels that it lights.
typedef struct {
  int number;
  channels_t channels;
  real eta;
} chain_t;

static inline realL largest_weight(const packetL *packet) {
  realL largest = packet->weight[0];
  for (int k = 1; k < WEIGHTS; k++) largest = fmax(largest, packet->weight[k]);
  return largest;
}

static inline void scale_weights(packetL *packet, realL factor) {
  for (int k = 0; k < WEIGHTS; k++) packet->weight[k] *= factor;
}

// What `weight` adds to a pixel's sum over the three channels.
static inline realL over_channels(const packetL *packet) {
  realL sum = packet->weight[0];
  for (int k = 1; k < WEIGHTS; k++) sum += packet->weight[k];
  return WEIGHTS == CHANNELS ? sum : CHANNELS * sum;
}

// Adds a packet's radiance, and the weight that it loses, to its pixels.
static inline void deposit(tile_t *tile, chain_t chain, maskL mask, const packetL *packet, realL cut) {
  int keep[LANES], pixel[LANES];
  real radiance[CHANNELS][LANES], lost[LANES];
  store_mask(mask, keep);
  store_ints(packet->tag & PIXEL_MASK, pixel);
  for (int k = 0; k < CHANNELS; k++) store_lanes(packet->radiance[k], radiance[k]);
  store_lanes(cut, lost);
  for (int lane = 0; lane < LANES; lane++) {
    if (!keep[lane]) continue;
    for (int k = 0; k < CHANNELS; k++) tile->radiance[chain.channels.first + k][pixel[lane]] += radiance[k][lane];
    tile->cut[pixel[lane]] += lost[lane];
  }
}

// Lets go into the room what has left the stone: adds what it gathers to the packet's radiance, and keeps for later what
// may meet the stone again: what a mirror sends back, and, of a stone that is not convex, all that is not known to be
// `clear` of it. Returns the weight that was dropped.
static inline realL leave(world_t world, pools_t *pools, chain_t chain, packetL *packet, vec3L origin, vec3L direction,
                          realL share, maskL mask, bool clear) {
  rayL ray = {origin, direction, splat(0), splat(1)};
  maskL towards = mask;
  realL cut = splat(0);
  if (clear) {
    const radianceL radiance = gather(world, &ray, share * largest_weight(packet), &towards, &cut, chain.channels);
    for (int k = 0; k < CHANNELS; k++)
      packet->radiance[k] += blend(mask, share * packet->weight[min(k, WEIGHTS - 1)] * radiance.channel[k], splat(0));
    cut = blend(mask, cut * share * over_channels(packet), splat(0));
  }
  if (REENTRY && any_lane(towards)) {
    packetL back = *packet;
    back.origin = ray.origin;
    back.direction = ray.direction;
    scale_weights(&back, share * ray.weight);
    for (int k = 0; k < CHANNELS; k++) back.radiance[k] = splat(0);
    if (has_room(&pools->outside))
      push(&pools->outside, towards, back);
    else
      cut += blend(towards, over_channels(&back), splat(0));
  }
  return cut;
}

// Splits light that meets the stone from outside: what is reflected goes into the room, what enters starts a chain.
static inline void enter(world_t world, tile_t *tile, pools_t *pools, chain_t chain, packetL packet, vec3L point,
                         vec3L normal, maskL mask) {
  const int fresnel_kind = DECIDED(FRESNEL, world.scene->fresnel_kind);
  const realL cos_a = clamp(-dot3(packet.direction, normal), (realL)0, (realL)1);
  const realL cos_s = cosine_in_stone(cos_a, chain.eta);
  const realL reflected = reflectance(fresnel_kind, cos_a, cos_s, chain.eta);
  realL cut = leave(world, pools, chain, &packet, point, reflect3(packet.direction, -cos_a, normal), reflected, mask,
                    GEOMETRY != MESH);

  packetL inner = packet;
  inner.origin = point;
  const real ratio = 1 / chain.eta;
  inner.direction = renormalise(along(scale3(splat(ratio), packet.direction), ratio * cos_a - cos_s, normal));
  scale_weights(&inner, (real)1 - reflected);
  inner.tag = packet.tag & PIXEL_MASK;
  for (int k = 0; k < CHANNELS; k++) inner.radiance[k] = splat(0);
  const maskL goes_on = mask & (largest_weight(&inner) >= world.scene->cutoff) & (maskL)(has_room(&pools->inside) ? -1 : 0);
  push(&pools->inside, goes_on, inner);
  cut += blend(mask & !goes_on, over_channels(&inner), splat(0));
  deposit(tile, chain, mask, &packet, cut);
}

// Advances one packet of light inside the stone by a few segments, and puts back what survives.
static inline void advance(world_t world, tile_t *tile, pools_t *pools, chain_t chain) {
  const int fresnel_kind = DECIDED(FRESNEL, world.scene->fresnel_kind);
  maskL taken;
  packetL packet = pop(&pools->inside, &taken);
  maskL alive = taken;
  realL cut = splat(0);
  for (int segment = 0; segment < STRIDE && any_lane(alive); segment++) {
    const crossingL crossing = stone_exit(world, packet.origin, packet.direction, alive);
    tile->segments += count_mask(alive);
    packet.origin = along(packet.origin, crossing.t, packet.direction);
    if (ABSORPTION != 0) {
      for (int k = 0; k < WEIGHTS; k++)
        packet.weight[k] *= exp_fast(-world.scene->absorption[WEIGHTS == 3 ? k : chain.channels.first] * crossing.t);
    }
    const realL cos_s = clamp(dot3(packet.direction, crossing.normal), (realL)0, (realL)1);
    const realL squared = squared_cosine_in_air(cos_s, chain.eta);
    const maskL leaves = alive & (squared > 0);
    realL kept = splat(1);
    if (any_lane(leaves)) {
      const realL cos_a = sqrt(fmax(squared, (realL)0));
      kept = blend(leaves, reflectance(fresnel_kind, cos_a, cos_s, chain.eta), splat(1));
      const vec3L outward = renormalise(along(scale3(splat(chain.eta), packet.direction), cos_a - chain.eta * cos_s, crossing.normal));
      cut += leave(world, pools, chain, &packet, packet.origin, outward, (real)1 - kept, leaves, GEOMETRY != MESH);
    }
    scale_weights(&packet, kept);
    packet.direction = renormalise(reflect3(packet.direction, cos_s, crossing.normal));
    packet.tag += ONE_BOUNCE;
    const maskL goes_on = alive & crossing.hit & (largest_weight(&packet) >= world.scene->cutoff) &
                          widen((packet.tag >> PIXEL_BITS) < (intL)(world.scene->max_bounces));
    cut += blend(alive & !goes_on, over_channels(&packet), splat(0));
    alive = goes_on;
  }
  if (any_lane(alive)) push(&pools->inside, alive, packet);
  const maskL ended = taken & !alive;
  if (any_lane(ended)) deposit(tile, chain, ended, &packet, cut);
}

// Takes one packet of light that a mirror has sent towards the stone: it enters, or goes on through the room.
static inline void come_back(world_t world, tile_t *tile, pools_t *pools, chain_t chain) {
  maskL taken;
  packetL packet = pop(&pools->outside, &taken);
  const crossingL crossing = stone_entry(world, packet.origin, packet.direction, splat(0), taken);
  const rayL ray = {packet.origin, packet.direction, splat(0), splat(1)};
  const maskL meets = crossing.hit & !hidden_by_room(world, ray, crossing.t);
  const maskL hits = taken & meets, misses = taken & !meets;
  if (any_lane(misses)) {
    packetL passing = packet;
    const realL cut = leave(world, pools, chain, &passing, packet.origin, packet.direction, splat(1), misses, true);
    deposit(tile, chain, misses, &passing, cut);
  }
  if (any_lane(hits)) enter(world, tile, pools, chain, packet, along(packet.origin, crossing.t, packet.direction), crossing.normal, hits);
}

// Appends the lanes of a packet of first hits that the mask names; `first` is the packet's first pixel.
static inline void note(hits_t *hits, maskL mask, vec3L point, vec3L direction, vec3L normal, realL weight, int first) {
  int keep[LANES];
  real quantity[10][LANES];
  store_mask(mask, keep);
  store_lanes(point.x, quantity[0]);
  store_lanes(point.y, quantity[1]);
  store_lanes(point.z, quantity[2]);
  store_lanes(direction.x, quantity[3]);
  store_lanes(direction.y, quantity[4]);
  store_lanes(direction.z, quantity[5]);
  store_lanes(normal.x, quantity[6]);
  store_lanes(normal.y, quantity[7]);
  store_lanes(normal.z, quantity[8]);
  store_lanes(weight, quantity[9]);
  int end = hits->count;
  for (int lane = 0; lane < LANES; lane++) {
    for (int k = 0; k < 3; k++) {
      hits->point[k][end] = quantity[k][lane];
      hits->direction[k][end] = quantity[3 + k][lane];
      hits->normal[k][end] = quantity[6 + k][lane];
    }
    hits->weight[end] = quantity[9][lane];
    hits->pixel[end] = first + lane;
    end += keep[lane] != 0;
  }
  hits->count = end;
}

// Makes the lanes of the last packet that hold no hit repeat the first one: finite, whatever the stack held before.
static inline void fill(hits_t *hits) {
  for (int i = hits->count; i < hits->count + LANES; i++) {
    for (int k = 0; k < 3; k++) {
      hits->point[k][i] = hits->point[k][0];
      hits->direction[k][i] = hits->direction[k][0];
      hits->normal[k][i] = hits->normal[k][0];
    }
    hits->weight[i] = hits->weight[0];
    hits->pixel[i] = hits->pixel[0];
  }
}

// Follows the light of all first hits for one index of refraction to its end.
static inline void trace(world_t world, tile_t *tile, pools_t *pools, chain_t chain, const hits_t *hits) {
  const int camera_inside = DECIDED(CAMERA_INSIDE, world.scene->camera_inside);
  int next = 0;
  for (;;) {
    // Light that has come back goes first: it is what makes the pools grow.
    if (REENTRY && (pools->outside.count >= LANES || (next >= hits->count && pools->inside.count == 0 && pools->outside.count > 0)))
      come_back(world, tile, pools, chain);
    else if (pools->inside.count >= LANES || (next >= hits->count && pools->inside.count > 0))
      advance(world, tile, pools, chain);
    else if (next < hits->count) {
      const maskL mask = widen(LANE_INDEX < (intL)(hits->count - next));
      packetL packet;
      const vec3L point = vec3(load_lanes(hits->point[0] + next), load_lanes(hits->point[1] + next), load_lanes(hits->point[2] + next));
      const vec3L normal = vec3(load_lanes(hits->normal[0] + next), load_lanes(hits->normal[1] + next), load_lanes(hits->normal[2] + next));
      packet.origin = point;
      packet.direction = vec3(load_lanes(hits->direction[0] + next), load_lanes(hits->direction[1] + next), load_lanes(hits->direction[2] + next));
      for (int k = 0; k < WEIGHTS; k++) packet.weight[k] = load_lanes(hits->weight + next);
      for (int k = 0; k < CHANNELS; k++) packet.radiance[k] = splat(0);
      packet.tag = load_ints(hits->pixel + next);
      if (camera_inside)
        push(&pools->inside, mask, packet);
      else
        enter(world, tile, pools, chain, packet, point, normal, mask);
      next += LANES;
    } else
      return;
  }
}

#endif
