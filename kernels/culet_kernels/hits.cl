// Where pixels' rays first meet the stone, waiting for their chains.
#ifndef CULET_HITS
#define CULET_HITS
#include "pool.cl"
#include "room.cl"
#include "tile.cl"

// Each group of pixels has its own, since it sees other chains. A packet is written whole, and counted as far as it is meant.
#define HITS (TILE_PIXELS / GROUPS + LANES)
#define HIT_NUMBERS (POLARISED ? 16 : 10)

typedef struct {
  real number[HIT_NUMBERS][HITS]; // point, direction, normal, weight, polarisation
  int pixel[HITS];
  int count;
} hits_t;

// Appends the lanes of a packet of rays that the mask names; `first` is the packet's first pixel.
static inline void note(hits_t *hits, maskL mask, vec3L point, rayL ray, vec3L normal, int first) {
  int keep[LANES];
  real number[16][LANES];
  store_mask(mask, keep);
  store_lanes(point.x, number[0]);
  store_lanes(point.y, number[1]);
  store_lanes(point.z, number[2]);
  store_lanes(ray.direction.x, number[3]);
  store_lanes(ray.direction.y, number[4]);
  store_lanes(ray.direction.z, number[5]);
  store_lanes(normal.x, number[6]);
  store_lanes(normal.y, number[7]);
  store_lanes(normal.z, number[8]);
  store_lanes(ray.weight, number[9]);
  store_polarisation(ray.polarisation, number + 10);
  int end = hits->count;
  for (int lane = 0; lane < LANES; lane++) {
    for (int k = 0; k < HIT_NUMBERS; k++) hits->number[k][end] = number[k][lane];
    hits->pixel[end] = first + lane;
    end += keep[lane] != 0;
  }
  hits->count = end;
}

// Makes the lanes of the last packet that hold no hit repeat the first one: finite, whatever the stack held before.
static inline void fill(hits_t *hits) {
  for (int i = hits->count; i < hits->count + LANES; i++) {
    for (int k = 0; k < HIT_NUMBERS; k++) hits->number[k][i] = hits->number[k][0];
    hits->pixel[i] = hits->pixel[0];
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
  for (int k = 0; k < WEIGHTS; k++) packet.weight[k] = load_lanes(hits->number[9] + place);
  for (int k = 0; k < CHANNELS; k++) packet.radiance[k] = splat(0);
  packet.polarisation = load_polarisation(hits->number[POLARISED ? 10 : 0] + place, HITS);
  packet.tag = load_ints(hits->pixel + place);
  return packet;
}

#endif
