// What is drawn at once of each pixel, and where the rays of a packet go through the picture.
#ifndef CULET_BATCH
#define CULET_BATCH
#include "features.cl"
#include "parameters.cl"

// What is drawn at once: 1, 4 or 16 samples of each pixel. Samples of a pixel lie side by side in a tile, in squares of as many
// columns and rows, so that a packet has rays that are as near to each other as they can be.
typedef struct {
  __global const double *jitter; // of each sample, from the pixel's upper left corner, in pixels: column and row
  int level;                     // there are 4^level samples
} batch_t;

static inline int side_of(batch_t batch) { return 1 << batch.level; }

// A tile's samples are numbered square by square, which hold all samples of a pixel, and in each packet by packet.
#define SQUARE_SIDE 4
#define SQUARE (SQUARE_SIDE * SQUARE_SIDE)

// In its square, the first place of the packet that begins at a column and a row.
static inline int first_in_square(int x, int y) {
  const int packets = SQUARE_SIDE / PACKET_WIDTH;
  return (y % SQUARE_SIDE / PACKET_HEIGHT * packets + x % SQUARE_SIDE / PACKET_WIDTH) * LANES;
}

// Which sample of the batch has a place in a square.
static inline int sample_of(int level, int place) {
  const int packet = place / LANES, lane = place % LANES, packets = SQUARE_SIDE / PACKET_WIDTH;
  const int x = packet % packets * PACKET_WIDTH + lane % PACKET_WIDTH,
            y = packet / packets * PACKET_HEIGHT + lane / PACKET_WIDTH, last = (1 << level) - 1;
  return ((y & last) << level) + (x & last);
}

// Where the rays of a packet go through the picture.
typedef struct {
  intL column, row;     // of the pixel
  intL sample;          // of the batch
  doubleL x, y;         // pixels from the picture's upper left corner,
  doubleL right, down;  // and from the pixel's
  realL tilt_x, tilt_z; // the same from -1 to 1
} spotsL;

static inline doubleL from_edge(intL pixel, doubleL jitter, int side) {
  return ints_to_double(pixel & (side - 1)) + (ints_to_double(pixel & -side) + jitter);
}

// Which samples a packet at a column and a row has. `*known` says of which packet that is known, or is negative; most packets of a tile
// have the same.
static inline void take_samples(spotsL *spots, batch_t batch, int x, int y, int *known) {
  const int last = side_of(batch) - 1, kind = (y & last) << batch.level | (x & last);
  if (kind == *known) return;
  *known = kind;
  spots->sample = (((y + PACKET_Y) & last) << batch.level) + ((x + PACKET_X) & last);
  int sample[LANES];
  double jitter[2][LANES];
  store_ints(spots->sample, sample);
  for (int lane = 0; lane < LANES; lane++)
    for (int k = 0; k < 2; k++) jitter[k][lane] = batch.jitter[2 * sample[lane] + k];
  spots->right = load_doubles(jitter[0]);
  spots->down = load_doubles(jitter[1]);
  spots->tilt_x = from_double(clamp(2 * spots->right - 1, (doubleL)-1.0, (doubleL)1.0));
  spots->tilt_z = from_double(clamp(2 * spots->down - 1, (doubleL)-1.0, (doubleL)1.0));
}

// Those of the packet that begins at a column and a row of a batch's samples. Places are rounded the same, however many samples
// are drawn at once.
static inline void move_spots(spotsL *spots, batch_t batch, int x, int y, int *known) {
  take_samples(spots, batch, x, y, known);
  spots->column = (x + PACKET_X) >> batch.level;
  spots->row = (y + PACKET_Y) >> batch.level;
  if (batch.level == 0) {
    spots->x = ints_to_double(PACKET_X) + (x + batch.jitter[0]);
    spots->y = ints_to_double(PACKET_Y) + (y + batch.jitter[1]);
  } else {
    spots->x = from_edge(spots->column, spots->right, PACKET_WIDTH);
    spots->y = from_edge(spots->row, spots->down, PACKET_HEIGHT);
  }
}

// Which pixels of a packet are in the picture.
static inline maskL in_picture(__constant const parameters_t *scene, const spotsL *spots) {
  return widen((spots->column < (intL)(scene->width)) & (spots->row < (intL)(scene->height)));
}

// The groups that a packet's pixels belong to: the four of each square, in the next sample the next ones.
static inline intL groups_of(const spotsL *spots, int first_sample) {
  return (((spots->column & 1) + 2 * (spots->row & 1) + spots->sample + first_sample) & 3) % GROUPS;
}

#endif
