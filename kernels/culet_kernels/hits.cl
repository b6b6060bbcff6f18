// Where pixels' rays first meet a stone, waiting for their chains.
#ifndef CULET_HITS
#define CULET_HITS
#include "pool.cl"
#include "room.cl"
#include "tile.cl"

// A packet is written whole, and counted as far as it is meant.
#define HITS (TILE_PIXELS + LANES)

typedef struct {
  real number[NUMBERS][HITS]; // a ray that is at the surface
  int whole[WHOLES][HITS];
  real normal[3][HITS];       // of the facet
  int count;
} hits_t;

// Appends the rays of a packet that meet a stone; `tag` says their pixels.
static inline void note(world_t world, hits_t *hits, meetingL met, rayL ray, intL tag) {
  packetL packet;
  packet.direction = ray.direction;
  EACH (k, WEIGHTS) packet.weight[k] = ray.weight;
  packet.polarisation = ray.polarisation;
  packet.tag = tag;
  packet.stone = met.stone;
#if RECORDED
  packet.event = ray.event;
#endif
  bring(world, &packet, met);
  const packing_t packing = packing_of(met.hit);
  const int end = hits->count;
  pack_packet(packing, &packet, hits->number[0] + end, hits->whole[0] + end, HITS);
  pack_lanes(packing, met.normal.x, hits->normal[0] + end);
  pack_lanes(packing, met.normal.y, hits->normal[1] + end);
  pack_lanes(packing, met.normal.z, hits->normal[2] + end);
  hits->count = end + packing.count;
}

// Makes the lanes of the last packet that hold no hit repeat the first one: finite, whatever the stack held before.
static inline void fill(hits_t *hits) {
  for (int i = hits->count; i < hits->count + LANES; i++) {
    EACH (k, NUMBERS) hits->number[k][i] = hits->number[k][0];
    EACH (k, WHOLES) hits->whole[k][i] = hits->whole[k][0];
    EACH (k, 3) hits->normal[k][i] = hits->normal[k][0];
  }
}

// The packet that begins at a place in the list, and the surface that it meets.
static inline packetL hits_at(const hits_t *hits, int place, vec3L *normal) {
  *normal = vec3(load_lanes(hits->normal[0] + place), load_lanes(hits->normal[1] + place),
                 load_lanes(hits->normal[2] + place));
  return load_packet(hits->number[0] + place, hits->whole[0] + place, HITS);
}

#endif
