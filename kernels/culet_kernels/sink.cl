// Where chains end: what they show goes to the pixels, what they drop is counted.
#ifndef CULET_SINK
#define CULET_SINK
#include "packet.cl"
#include "sky.cl"
#include "stones.cl"
#include "task.cl"
#include "tile.cl"
#include "witness.cl"

// Where light ends: in the tile's pixels.
//
// Adds to a packet's pixels what its weight shows of a radiance.
static inline void show(tile_t *tile, task_t task, maskL mask, const packetL *packet, radianceL seen) {
  int pixel[LANES];
  real radiance[CHANNELS][LANES];
  const packing_t packing = packing_of(mask);
  pack_ints(packing, packet->tag & PIXEL_MASK, pixel);
  EACH (k, CHANNELS) {
    const realL light = packet->weight[min(k, WEIGHTS - 1)] * seen.channel[k];
    pack_lanes(packing, SPECTRAL ? OF_CHAIN(task, packet->tag, share[k]) * light : light, radiance[k]);
  }
  for (int i = 0; i < packing.count; i++)
    EACH (k, CHANNELS) tile->radiance[task.first_channel + k][pixel[i]] += radiance[k][i];
}

// Counts weight that is dropped, over the channels.
static inline void lose(tile_t *tile, maskL mask, const packetL *packet, realL cut) {
  if (!any_lane(mask)) return;
  int pixel[LANES];
  real lost[LANES];
  const packing_t packing = packing_of(mask);
  pack_ints(packing, packet->tag & PIXEL_MASK, pixel);
  pack_lanes(packing, cut, lost);
  for (int i = 0; i < packing.count; i++) tile->cut[pixel[i]] += lost[i];
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

// 1, halved so many times, from 0 to MOST_HALVINGS: the eighth power of a polynomial (least squares of the relative error over that
// range, which is below 5e-04).
static inline realL halved(realL times) {
  const realL x = times * (real)0.125;
  realL part = fma(x, fma(x, fma(x, splat((real)-0.0452), splat((real)0.2366)), splat((real)-0.6928)), splat(1));
  part *= part;
  part *= part;
  return part * part;
}

// The weight below which a chain ends. Where light comes back to stones, each pixel has a tree of chains, and where each of them
// loses a cut-off, some lose a hundred. Here their sum grows like the logarithm of their number, down to a least cut-off
// that bounds what it costs. Of sampled wavelengths one channel may lose twice the mean.
static inline realL cutoff_now(world_t world, const tile_t *tile, task_t task, const packetL *packet) {
  const real cutoff = world.scene->cutoff, channels = SPECTRAL ? (real)1.5 : (real)(task.first_channel + CHANNELS);
  const realL lost = gather_lanes(tile->cut, packet->tag & PIXEL_MASK);
  const realL excess = fma(lost, splat(1 / (cutoff * channels)), splat(-AMPLE));
  return cutoff * halved(clamp(HALVINGS * excess, (realL)0, (realL)MOST_HALVINGS));
}

// What becomes of chains whose weight is below the cut-off, or whose bounces are used up: which go on. What ends is added
// to `cut`. `place` says where it is. Only where weights `fell` since this was asked last, can a chain end that went on then: a
// pixel's cut-off is lowered, never raised.
static inline maskL settle(world_t world, tile_t *tile, task_t task, packetL *packet, int place, maskL mask,
                           maskL used_up, maskL fell) {
  const int end_kind = DECIDED(END, world.scene->end_kind);
  const realL weight = largest_weight(packet);
  maskL ends = mask & (used_up | (weight < world.scene->cutoff));
  const int by_pixel = EXCHANGE ? world.scene->stones > 1 || !world.stones->convex : 0;
  if (end_kind == ROULETTE ? 0 : by_pixel) ends &= used_up | fell;
  if (!any_lane(ends)) return mask;
  if (end_kind == ROULETTE) { // Arvo & Kirk, Particle Transport and Image Synthesis (1990)
    const maskL faint = ends & !used_up, lucky = faint & (chance(task, packet) * world.scene->cutoff < weight);
    scale_weights(packet, blend(lucky, world.scene->cutoff / fmax(weight, splat((real)1e-30)), splat(1)));
#if RECORDED
    if (lucky)
      packet->event =
          tell_chance(world, task, packet, place == INSIDE, world.scene->cutoff / fmax(weight, (real)1e-30));
    if (ends & !lucky) tell_end(world, task, packet, place, black());
#endif
    lose(tile, ends & used_up, packet, over_channels(task, packet));
    return mask & (lucky | !ends);
  }
  if (by_pixel) ends &= used_up | (weight < cutoff_now(world, tile, task, packet));
  radianceL seen = black();
  if (end_kind == SKYLIGHT) {
    const vec3L direction = at_stone(place) ? outward_of(world, packet, packet->direction) : packet->direction;
    seen = sky(world, direction, channels_of(task));
    show(tile, task, ends, packet, seen);
  }
#if RECORDED
  if (ends) tell_end(world, task, packet, place, seen);
#endif
  lose(tile, ends, packet, over_channels(task, packet));
  return mask & !ends;
}

#endif
