// A packet of rays: what a ray carries along, and the rows of numbers in which packets are kept.
#ifndef CULET_PACKET
#define CULET_PACKET
#include "polarisation.cl"

// A ray's tag: its pixel within the tile, above that the group that the pixel belongs to, and above that how often the ray
// has met the surface from inside.
#define PIXEL_BITS 12
#define GROUP_BITS 2
#define PIXEL_MASK ((1 << PIXEL_BITS) - 1)
#define BOUNCE_SHIFT (PIXEL_BITS + GROUP_BITS)
#define ONE_BOUNCE (1 << BOUNCE_SHIFT)

// A chain has one weight; one that the channels share has one for each, where they are absorbed unequally.
#define WEIGHTS (!SPECTRAL && DISPERSION == 0 && ABSORPTION != 0 ? 3 : 1)

typedef struct {
  vec3L origin, direction;
  realL weight[WEIGHTS];
  polarisationL polarisation;
  intL tag;
#if RECORDED
  intL event; // number of the event that it comes from
#endif
  intL stone; // MANY: its number. Where a ray is at a stone or in it, its origin is in the stone's own measure.
} packetL;

// Does something with each number of a packet, in the order of its rows. This list and the one of the whole numbers are all
// that says how a packet is kept.
#define NUMBERS (6 + WEIGHTS + (POLARISED ? 6 : 0))
#define EACH_NUMBER(packet, WITH)                                                                                      \
  WITH((packet)->origin.x)                                                                                             \
  WITH((packet)->origin.y)                                                                                             \
  WITH((packet)->origin.z)                                                                                             \
  WITH((packet)->direction.x)                                                                                          \
  WITH((packet)->direction.y)                                                                                          \
  WITH((packet)->direction.z)                                                                                          \
  EACH (k, WEIGHTS) {                                                                                                  \
    WITH((packet)->weight[k])                                                                                          \
  }                                                                                                                    \
  if (POLARISED) {                                                                                                     \
    WITH((packet)->polarisation.q)                                                                                     \
    WITH((packet)->polarisation.u)                                                                                     \
    WITH((packet)->polarisation.v)                                                                                     \
    WITH((packet)->polarisation.axis.x)                                                                                \
    WITH((packet)->polarisation.axis.y)                                                                                \
    WITH((packet)->polarisation.axis.z)                                                                                \
  }
#define WHOLES ((STONES == MANY ? 2 : 1) + RECORDED)
#if RECORDED
#define EACH_EVENT(packet, WITH) WITH((packet)->event)
#else
#define EACH_EVENT(packet, WITH)
#endif
#define EACH_WHOLE(packet, WITH)                                                                                       \
  WITH((packet)->tag)                                                                                                  \
  if (STONES == MANY) {                                                                                                \
    WITH((packet)->stone)                                                                                              \
  }                                                                                                                    \
  EACH_EVENT(packet, WITH)

// Rows that lie `stride` numbers apart. A packet is written whole, and counted as far as it is meant.
#define PACK_WHOLE(number)                                                                                             \
  pack_ints(packing, number, wholes);                                                                                  \
  wholes += stride;
#define LOAD_WHOLE(number)                                                                                             \
  number = load_ints(wholes);                                                                                          \
  wholes += stride;

// The lanes of a packet that the packing takes, to rows.
static inline void pack_packet(packing_t packing, const packetL *packet, real *rows, int *wholes, int stride) {
  EACH_NUMBER(packet, PACK_NUMBER)
  EACH_WHOLE(packet, PACK_WHOLE)
}

__attribute__((always_inline)) static inline packetL load_packet(const real *rows, const int *wholes, int stride) {
  packetL packet;
  const realL none = splat(0);
  const polarisationL unknown = {none, none, none, {none, none, none}};
  packet.polarisation = unknown;
  packet.stone = (intL)(0);
  EACH_NUMBER(&packet, LOAD_NUMBER)
  EACH_WHOLE(&packet, LOAD_WHOLE)
  return packet;
}

#endif
