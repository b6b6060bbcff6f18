// Where pixels' rays first meet the stone, waiting for their chains.
#ifndef CULET_HITS
#define CULET_HITS
#include "pool.cl"
#include "room.cl"
#include "tile.cl"

// A packet is written whole, and counted as far as it is meant.
#define HITS (TILE_PIXELS + LANES)
#define HIT_NUMBERS (POLARISED ? 16 : 10)

typedef struct {
  real number[HIT_NUMBERS][HITS]; // point, direction, normal, weight, polarisation
  int tag[HITS];
  int count;
} hits_t;

// Appends the lanes of a packet of rays that the mask names; `tag` says their pixels.
static inline void note(hits_t *hits, maskL mask, vec3L point, rayL ray, vec3L normal, intL tag) {
  const packing_t packing = packing_of(mask);
  const int end = hits->count;
  pack_lanes(packing, point.x, hits->number[0] + end);
  pack_lanes(packing, point.y, hits->number[1] + end);
  pack_lanes(packing, point.z, hits->number[2] + end);
  pack_lanes(packing, ray.direction.x, hits->number[3] + end);
  pack_lanes(packing, ray.direction.y, hits->number[4] + end);
  pack_lanes(packing, ray.direction.z, hits->number[5] + end);
  pack_lanes(packing, normal.x, hits->number[6] + end);
  pack_lanes(packing, normal.y, hits->number[7] + end);
  pack_lanes(packing, normal.z, hits->number[8] + end);
  pack_lanes(packing, ray.weight, hits->number[9] + end);
  if (POLARISED) pack_polarisation(packing, ray.polarisation, hits->number[10] + end, HITS);
  pack_ints(packing, tag, hits->tag + end);
  hits->count = end + packing.count;
}

// Makes the lanes of the last packet that hold no hit repeat the first one: finite, whatever the stack held before.
static inline void fill(hits_t *hits) {
  for (int i = hits->count; i < hits->count + LANES; i++) {
    EACH (k, HIT_NUMBERS) hits->number[k][i] = hits->number[k][0];
    hits->tag[i] = hits->tag[0];
  }
}

// The packet that begins at a place in the list, and the surface that it meets.
static inline packetL hits_at(const hits_t *hits, int place, vec3L *normal) {
  packetL packet;
  packet.origin = vec3(load_lanes(hits->number[0] + place), load_lanes(hits->number[1] + place),
                       load_lanes(hits->number[2] + place));
  packet.direction = vec3(load_lanes(hits->number[3] + place), load_lanes(hits->number[4] + place),
                          load_lanes(hits->number[5] + place));
  *normal = vec3(load_lanes(hits->number[6] + place), load_lanes(hits->number[7] + place),
                 load_lanes(hits->number[8] + place));
  EACH (k, WEIGHTS) packet.weight[k] = load_lanes(hits->number[9] + place);
  EACH (k, CHANNELS) packet.radiance[k] = splat(0);
  packet.polarisation = load_polarisation(hits->number[POLARISED ? 10 : 0] + place, HITS);
  packet.tag = load_ints(hits->tag + place);
  return packet;
}

#endif
