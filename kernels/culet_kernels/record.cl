// What becomes of one ray's light, written down event by event while the chains of this renderer follow it: path.cl.
#ifndef CULET_RECORD
#define CULET_RECORD
#include "features.cl"

// Kinds of event.
#define ENTERS 0 // a stone, from outside: the part that is kept out is its surface's reflection
#define MEETS 1  // a stone's surface, from inside: the part that is kept in is reflected
#define SEES 2   // the sky, or what the camera has in its place
#define LANDS 3  // on floor or wall
#define ENDS 4   // weight is dropped
#define CHANCE 5 // a faint chain goes on with more weight, by roulette

// In place of an event's number.
#define NOWHERE (-1) // there is none before
#define UNTOLD (-2)  // it found no room

// One ray, of one chain or, where the camera sees the room, of all. Positions are of the frame.
typedef struct {
  int kind;
  int parent;           // number of the event that the ray comes from
  int stone;            // its row in the table
  int chain;            // of its material's chains; -1: all
  int surface;          // LANDS: of the room
  int inside;           // ENDS, CHANCE: whether that is in a stone
  real point[3];        // where; of SEES from where
  real direction[3];    // of the ray there
  real normal[3];       // outward of a stone, inward of the room
  real length;          // R of the way in the stone that led here
  real weight[2];       // where the ray came from, and here, after absorption
  real kept;            // part of the weight: see the kinds
  real polarisation[3]; // q, u, v of the weight here, see polarisation.cl; the axis is normal x direction
  real light[3];        // what the pixel shows of it, by channel
  real cut;             // weight that is dropped, summed over the channels
} happening_t;

// Of all events of a pixel.
typedef struct {
  int count, most;  // events that happened, and that there is room for
  int done;
  real radiance[3]; // the pixel's value
  real cut;         // weight that was dropped, summed over the channels
} record_t;

#endif
