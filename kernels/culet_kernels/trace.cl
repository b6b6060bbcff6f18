// The light of one tile of pixels, by chains.
//
// In a convex stone light follows a single chain: at each facet the transmitted part leaves, the reflected part goes on,
// until its weight is under the cut-off. What leaves is followed through the room at once; a mirror may send it back to
// the stone, where it starts another chain. All of it waits in pools of rays, so that packets are full.
//
// A work-item is at one tile at a time. It first finds where each pixel's ray meets the stone, then takes the chains one
// index of refraction after the other, or four neighbouring wavelengths at a time, one for each group of pixels.
#ifndef CULET_TRACE
#define CULET_TRACE
#include "fresnel.cl"
#include "hits.cl"

// Segments of a chain between two looks at which of the packet's lanes have ended: a lane that idles for a segment costs
// less than sorting the packet each time.
#ifndef STRIDE
#define STRIDE 2
#endif

typedef struct {
  pool_t inside, outside;
} pools_t;

// What all rays of a pool have in common while it is worked on.
typedef struct {
  __global const chain_t *chains; // by group of pixels
  int first_channel;
  uint seed;                      // of chance
} task_t;

// How many they are is written out, not kept in the task, so that the compiler knows it in functions that it does not inline.
static inline channels_t channels_of(task_t task) {
  const channels_t channels = {task.first_channel, CHANNELS};
  return channels;
}

// A quantity of each lane's chain.
#if SPECTRAL
#define OF_CHAIN(task, tag, quantity)                                                                                  \
  by_group(tag, (task).chains[0].quantity, (task).chains[1].quantity, (task).chains[2].quantity,                       \
           (task).chains[3].quantity)
static inline realL by_group(intL tag, real first, real second, real third, real fourth) {
  const maskL odd = widen((tag >> PIXEL_BITS & 1) != 0), high = widen((tag >> PIXEL_BITS & 2) != 0);
  return blend(high, blend(odd, splat(fourth), splat(third)), blend(odd, splat(second), splat(first)));
}
#else
#define OF_CHAIN(task, tag, quantity) ((task).chains[0].quantity)
#endif

static inline realL largest_weight(const packetL *packet) {
  realL largest = packet->weight[0];
  for (int k = 1; k < WEIGHTS; k++) largest = fmax(largest, packet->weight[k]);
  return largest;
}

static inline void scale_weights(packetL *packet, realL factor) {
  EACH (k, WEIGHTS) packet->weight[k] *= factor;
}

// What a packet's weight is in a pixel's sum over the three channels.
static inline realL summed_weight(task_t task, const packetL *packet) {
  if (WEIGHTS == 3) return packet->weight[0] + packet->weight[1] + packet->weight[2];
  if (SPECTRAL) return OF_CHAIN(task, packet->tag, summed_share) * packet->weight[0];
  return CHANNELS * packet->weight[0];
}

// The most that a packet's weight can be in a pixel's sum over the three channels. Boundaries to come may turn polarisation
// into intensity.
static inline realL over_channels(task_t task, const packetL *packet) {
  const realL weight = summed_weight(task, packet);
  if (!POLARISED) return weight;
  const polarisationL p = packet->polarisation;
  return weight * (1 + sqrt(p.q * p.q + p.u * p.u + p.v * p.v));
}

// Adds a packet's radiance, and the weight that it loses, to its pixels.
static inline void deposit(tile_t *tile, task_t task, maskL mask, const packetL *packet, realL cut) {
  int keep[LANES], pixel[LANES];
  real radiance[CHANNELS][LANES], lost[LANES];
  store_mask(mask, keep);
  store_ints(packet->tag & PIXEL_MASK, pixel);
  EACH (k, CHANNELS)
    store_lanes(SPECTRAL ? OF_CHAIN(task, packet->tag, share[k]) * packet->radiance[k] : packet->radiance[k],
                radiance[k]);
  store_lanes(cut, lost);
  for (int lane = 0; lane < LANES; lane++) {
    if (!keep[lane]) continue;
    EACH (k, CHANNELS) tile->radiance[task.first_channel + k][pixel[lane]] += radiance[k][lane];
    tile->cut[pixel[lane]] += lost[lane];
  }
}

// Lets go into the room what has left the stone: adds what it gathers to the packet's radiance, and keeps for later what
// may meet the stone again: what a mirror sends back, and, of a stone that is not convex, all that is not known to be
// `clear` of it. Returns the weight that was dropped.
static inline realL leave(world_t world, pools_t *pools, task_t task, packetL *packet, vec3L origin, vec3L direction,
                          realL share, polarisationL polarisation, maskL mask, bool clear) {
  rayL ray = {origin, direction, splat(0), splat(1), polarisation};
  maskL towards = mask;
  realL cut = splat(0);
  if (clear) {
    const radianceL radiance =
        gather(world, &ray, share * largest_weight(packet), BY_STONE, 0, &towards, 0, &cut, channels_of(task));
    EACH (k, CHANNELS)
      packet->radiance[k] += blend(mask, share * packet->weight[min(k, WEIGHTS - 1)] * radiance.channel[k], splat(0));
    cut = blend(mask, cut * share * over_channels(task, packet), splat(0));
  }
  if (REENTRY && any_lane(towards)) {
    packetL back = *packet;
    back.origin = ray.origin;
    back.direction = ray.direction;
    back.polarisation = ray.polarisation;
    scale_weights(&back, share * ray.weight);
    EACH (k, CHANNELS) back.radiance[k] = splat(0);
    if (has_room(&pools->outside))
      push(&pools->outside, towards, &back);
    else
      cut += blend(towards, over_channels(task, &back), splat(0));
  }
  return cut;
}

// A number from 0 to 1 for each lane, by an integer hash (C. Wellons, Prospecting for Hash Functions, 2018: lowbias32).
static inline realL chance(task_t task, const packetL *packet) {
  real number[LANES];
  int tag[LANES];
  real weight[LANES];
  store_ints(packet->tag, tag);
  store_lanes(packet->weight[0], weight);
  for (int lane = 0; lane < LANES; lane++) {
    uint x =
        (uint)tag[lane] ^ task.seed ^ as_uint((float)weight[lane]) * 0x9e3779b9u; // the weight tells branches apart
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    number[lane] = (real)(x >> 8) * (real)(1.0f / (1 << 24));
  }
  return load_lanes(number);
}

// Cut-offs that a pixel's channel may lose before its cut-off is lowered, how many times it is then halved for each further
// one, and how often at most.
#define AMPLE ((real)1.5)
#define HALVINGS ((real)3)
#define MOST_HALVINGS ((real)5)

// The weight below which a chain ends. In a stone that is not convex each pixel has a tree of chains, and where each of them
// loses a cut-off, some lose a hundred. Here their sum grows like the logarithm of their number, down to a least cut-off
// that bounds what it costs. Of sampled wavelengths one channel may lose twice the mean.
static inline realL cutoff_now(world_t world, const tile_t *tile, task_t task, const packetL *packet) {
  const real cutoff = world.scene->cutoff, channels = SPECTRAL ? (real)1.5 : (real)(task.first_channel + CHANNELS);
  int pixel[LANES];
  real lost[LANES];
  store_ints(packet->tag & PIXEL_MASK, pixel);
  for (int lane = 0; lane < LANES; lane++) lost[lane] = tile->cut[pixel[lane]];
  const realL excess = load_lanes(lost) / (cutoff * channels) - AMPLE;
  return cutoff * exp2(-clamp(HALVINGS * excess, (realL)0, (realL)MOST_HALVINGS));
}

// What becomes of chains whose weight is below the cut-off, or whose bounces are used up: which go on. What ends is added
// to `cut`.
static inline maskL settle(world_t world, const tile_t *tile, task_t task, packetL *packet, maskL mask, maskL used_up,
                           realL *cut) {
  const int end_kind = DECIDED(END, world.scene->end_kind);
  const realL weight = largest_weight(packet);
  maskL ends = mask & (used_up | (weight < world.scene->cutoff));
  if (!any_lane(ends)) return mask;
  if (end_kind == ROULETTE) { // Arvo & Kirk, Particle Transport and Image Synthesis (1990)
    const maskL faint = ends & !used_up, lucky = faint & (chance(task, packet) * world.scene->cutoff < weight);
    scale_weights(packet, blend(lucky, world.scene->cutoff / fmax(weight, splat((real)1e-30)), splat(1)));
    *cut += blend(ends & used_up, over_channels(task, packet), splat(0));
    return mask & (lucky | !ends);
  }
  if (GEOMETRY == MESH && !world.scene->convex) ends &= used_up | (weight < cutoff_now(world, tile, task, packet));
  if (end_kind == SKYLIGHT) {
    const radianceL fallback = sky(world, packet->direction, channels_of(task));
    EACH (k, CHANNELS)
      packet->radiance[k] += blend(ends, packet->weight[min(k, WEIGHTS - 1)] * fallback.channel[k], splat(0));
  }
  *cut += blend(ends, over_channels(task, packet), splat(0));
  return mask & !ends;
}

// The boundary's reflectance for a packet, and its polarisation on either side.
static inline splitL meet_boundary(world_t world, task_t task, const packetL *packet, vec3L normal, realL cos_a,
                                   realL cos_s, realL squared_a, chainL eta) {
  splitL result;
  if (POLARISED) return split(align(packet->polarisation, packet->direction, normal), cos_a, cos_s, squared_a, eta);
  const int fresnel_kind = DECIDED(FRESNEL, world.scene->fresnel_kind);
  result.kept = blend(squared_a > 0, reflectance(fresnel_kind, cos_a, cos_s, eta), splat(1));
  result.reflected = result.transmitted = packet->polarisation;
  return result;
}

// Splits light that meets the stone from outside: what is reflected goes into the room, if `glare` says so, and what
// enters starts a chain.
static inline void enter(world_t world, tile_t *tile, pools_t *pools, task_t task, packetL *packet, vec3L point,
                         vec3L normal, maskL mask, bool glare) {
  const realL cos_a = clamp(-dot3(packet->direction, normal), (realL)0, (realL)1);
  const chainL eta = OF_CHAIN(task, packet->tag, eta);
  const realL cos_s = cosine_in_stone(cos_a, eta);
  const splitL parts =
      meet_boundary(world, task, packet, normal, cos_a, cos_s, fmax(cos_a * cos_a, splat((real)1e-30)), eta);
  realL cut = splat(0);
  if (glare)
    cut = leave(world, pools, task, packet, point, reflect3(packet->direction, -cos_a, normal), parts.kept,
                parts.reflected, mask, GEOMETRY != MESH);

  packetL inner = *packet;
  inner.origin = point;
  const realL ratio = splat(1) / eta;
  inner.direction = renormalise(along(scale3(ratio, packet->direction), ratio * cos_a - cos_s, normal));
  inner.polarisation = parts.transmitted;
  scale_weights(&inner, (real)1 - parts.kept);
  inner.tag = packet->tag & (ONE_BOUNCE - 1);
  maskL goes_on = settle(world, tile, task, &inner, mask, mask & !mask, &cut);
  if (!has_room(&pools->inside)) {
    cut += blend(goes_on, over_channels(task, &inner), splat(0));
    goes_on = goes_on & !goes_on;
  }
  push(&pools->inside, goes_on, &inner);
  // A chain that goes on takes what its first reflection has gathered along, but not what it has lost.
  EACH (k, CHANNELS) inner.radiance[k] = blend(goes_on, splat(0), inner.radiance[k]);
  const maskL left = mask & (!goes_on | (cut > 0));
  if (any_lane(left)) deposit(tile, task, left, &inner, cut);
}

// The direction of what stays inside. Where light comes back to the same directions for thousands of reflections, they are
// made in double precision: rounded at each step, directions drift past the critical angle (rendering/mirrors.py).
static inline vec3L reflect_inside(vec3L direction, realL cos_s, vec3L normal) {
  if (!FEW_MIRRORS) return renormalise(reflect3(direction, cos_s, normal));
  const doubleL x = to_double(direction.x), y = to_double(direction.y), z = to_double(direction.z),
                nx = to_double(normal.x), ny = to_double(normal.y), nz = to_double(normal.z);
  const doubleL twice = -2 * (x * nx + y * ny + z * nz) / (nx * nx + ny * ny + nz * nz);
  const doubleL rx = fma(twice, nx, x), ry = fma(twice, ny, y), rz = fma(twice, nz, z);
  const doubleL scale = 1.5 - 0.5 * (rx * rx + ry * ry + rz * rz); // to unit length
  return vec3(from_double(scale * rx), from_double(scale * ry), from_double(scale * rz));
}

// Advances one packet of light inside the stone by a few segments, and puts back what survives.
static inline void advance(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  packetL packet = pop(&pools->inside, &taken);
  const chainL eta = OF_CHAIN(task, packet.tag, eta);
  maskL alive = taken;
  realL cut = splat(0);
  for (int segment = 0; segment < STRIDE && any_lane(alive); segment++) {
    const crossingL crossing = stone_exit(world, packet.origin, packet.direction, alive);
    tile->segments += count_mask(alive);
    packet.origin = along(packet.origin, crossing.t, packet.direction);
    if (ABSORPTION != 0) {
      EACH (k, WEIGHTS)
        packet.weight[k] *= exp_fast(
            -(WEIGHTS == 3 ? world.scene->absorption[k] : OF_CHAIN(task, packet.tag, absorption)) * crossing.t);
    }
    const realL cos_s = clamp(dot3(packet.direction, crossing.normal), (realL)0, (realL)1);
    const realL squared_a = squared_cosine_in_air(cos_s, eta);
    const maskL leaves = alive & (squared_a > 0);
    if (POLARISED || any_lane(leaves)) {
      const realL cos_a = sqrt(fmax(squared_a, (realL)0));
      const splitL parts = meet_boundary(world, task, &packet, crossing.normal, cos_a, cos_s, squared_a, eta);
      if (any_lane(leaves)) {
        const vec3L outward =
            renormalise(along(scale3((realL)(eta), packet.direction), cos_a - eta * cos_s, crossing.normal));
        cut += leave(world, pools, task, &packet, packet.origin, outward, (real)1 - parts.kept, parts.transmitted,
                     leaves, GEOMETRY != MESH);
      }
      scale_weights(&packet, parts.kept);
      packet.polarisation = parts.reflected;
    }
    packet.direction = reflect_inside(packet.direction, cos_s, crossing.normal);
    packet.tag += ONE_BOUNCE;
    const maskL used_up = !crossing.hit | widen((packet.tag >> BOUNCE_SHIFT) >= (intL)(world.scene->max_bounces));
    alive = settle(world, tile, task, &packet, alive, used_up, &cut);
  }
  if (any_lane(alive)) push(&pools->inside, alive, &packet);
  maskL given = taken & !alive;
  if (REENTRY) { // a chain that goes on takes along what it has gathered, but not what mirrors have lost of it
    EACH (k, CHANNELS) packet.radiance[k] = blend(alive, splat(0), packet.radiance[k]);
    given |= alive & (cut > 0);
  }
  if (any_lane(given)) deposit(tile, task, given, &packet, cut);
}

// Takes one packet of light that a mirror has sent towards the stone: it enters, or goes on through the room.
static inline void come_back(world_t world, tile_t *tile, pools_t *pools, task_t task) {
  maskL taken;
  packetL packet = pop(&pools->outside, &taken);
  const crossingL crossing = stone_entry(world, packet.origin, packet.direction, splat(0), taken);
  const rayL ray = {packet.origin, packet.direction, splat(0), splat(1), packet.polarisation};
  const maskL meets = crossing.hit & !hidden_by_room(world, ray, crossing.t);
  const maskL hits = taken & meets, misses = taken & !meets;
  if (any_lane(misses)) {
    packetL passing = packet;
    const realL cut = leave(world, pools, task, &passing, packet.origin, packet.direction, splat(1),
                            packet.polarisation, misses, true);
    deposit(tile, task, misses, &passing, cut);
  }
  if (any_lane(hits))
    enter(world, tile, pools, task, &packet, along(packet.origin, crossing.t, packet.direction), crossing.normal, hits,
          true);
}

#endif
