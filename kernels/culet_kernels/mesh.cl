// A stone that is not convex: triangles in a tree of boxes, in the stone's own axes.
//
// Rays inside such a stone scatter, so a packet of them shares no way through the tree. The packet is of boxes instead:
// one ray is tested against all children of a node at once, and against all triangles of a leaf. The host makes the tree
// (rendering/stones/tree.py) and sees to it that there is room for all that waits.
#ifndef CULET_MESH
#define CULET_MESH
#include "hull.cl"

#ifndef TREE_WIDTH // children of a node, triangles of a leaf: 8 or 16
#define TREE_WIDTH 16
#endif
#ifndef TREE_STACK // (TREE_WIDTH - 1) x the tree's depth + 1, at most
#define TREE_STACK 128
#endif

typedef JOIN(REAL, TREE_WIDTH) realW;
typedef JOIN(MASK, TREE_WIDTH) maskW;
typedef JOIN(int, TREE_WIDTH) intW;
// In one piece: PoCL makes several of vload and vstore.
typedef realW anywhereW __attribute__((aligned(sizeof(real)), may_alias));
typedef intW ints_anywhereW __attribute__((aligned(sizeof(int)), may_alias));
static inline realW wide(__global const real *from) { return *(__global const anywhereW *)from; }
static inline realW load_wide(__global const real *from, int row) { return wide(from + row * TREE_WIDTH); }

// One bit for each component of a comparison. Eight bytes of 0 or 1 are gathered in the top byte of a product.
static inline uint byte_bits(uchar8 bytes) {
  return (uint)(((as_ulong(bytes) & 0x0101010101010101ul) * 0x0102040810204080ul) >> 56);
}
static inline uint mask_bits(maskW mask) {
#if TREE_WIDTH == 16 && AVX512
  return __builtin_ia32_cvtd2mask512(mask);
#elif TREE_WIDTH == 16
  const uchar16 bytes = as_uchar16(convert_char16(mask));
  return byte_bits(bytes.lo) | byte_bits(bytes.hi) << 8;
#else
  return byte_bits(as_uchar8(convert_char8(mask)));
#endif
}
#if TREE_WIDTH == 16
#define PLACES (intW)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#define PLACES (intW)(0, 1, 2, 3, 4, 5, 6, 7)
#endif
static inline int lowest_bit(uint bits) { return popcount((bits & -bits) - 1); }

// R by which rounding may place a ray's start behind a facet that is ahead of it, and cosines that it may turn about.
#if IS_DOUBLE
#define SLACK 1e-12
#else
#define SLACK 2e-6f
#endif
// A ray inside that starts outside by rounding, at an edge, may pass the stone by. Triangles are then widened, by this many
// R at first and WIDER times as much each time, until it finds one. It does: some facet is turned away from any ray, and no
// triangle is LAST_WIDENING away. 6e-6 was enough for most stones that were tried, 5e-5 for a needle of 1000 : 1.
#define FIRST_WIDENING SMALLEST_GAP
#ifndef LAST_WIDENING // 0: never
#define LAST_WIDENING ((real)16)
#endif
#define WIDER ((real)8)

typedef struct {
  // For each node the children's boxes and those of their normals: lower x, y, z and upper x, y, z, TREE_WIDTH of each.
  __global const real *boxes;
  __global const int *links;    // for each child the node, or ~leaf; of several trees one after the other
  __global const real *corners; // for each leaf three corners and the facet's normal, TREE_WIDTH of each
} tree_t;

// What is asked of the tree for each ray of a packet, and what was found: rows of a number for each ray.
typedef struct {
  real origin[3][LANES], direction[3][LANES];
  real start[LANES];   // hits before this do not count,
  real limit[LANES];   // nor do those behind this; becomes the nearest hit
  int triangle[LANES]; // leaf x TREE_WIDTH + place, -1 for none
  real widening;       // of triangles, R
  real widened[LANES]; // the same, when the hit was found
  real side;           // of a facet that counts: 1 outside, -1 inside
  // Of boxes. Along each axis a ray enters a box at one of its two sides, by the direction's sign, and leaves it at the other.
  uint first_side[3][LANES], last_side[3][LANES]; // rows of a node,
  uint most_facing[3][LANES];                     // and that of the normals in a box which are turned that way most
  real inverse[3][LANES];
  real enter[3][LANES], leave[3][LANES];          // where: this + inverse x the side's place
  real earliest[LANES];                           // boxes that end before this do not count
  real facing[3][LANES];                          // the way that facets which count are turned
  // Of triangles. z is the direction's longest axis; x and y are so that triangles that count turn left.
  uint axis[3][LANES];   // rows of a corner
  real turned[3][LANES]; // the origin, in these axes
  real shear[2][LANES];  // how far the ray goes along x and y for each step along z
} probes_t;

static inline realL away_from_zero(realL x) { return blend(fabs(x) < PARALLEL, copysign(splat(PARALLEL), x), x); }

// The axes of a ray's triangles: which is its z, and whether x and y change places.
typedef struct {
  maskL along_x, along_y, swaps;
} turnL;
static inline vec3L turned(turnL turn, vec3L v) {
  const realL x = blend(turn.along_x, v.y, blend(turn.along_y, v.z, v.x)),
              y = blend(turn.along_x, v.z, blend(turn.along_y, v.x, v.y)),
              z = blend(turn.along_x, v.x, blend(turn.along_y, v.y, v.z));
  return vec3(blend(turn.swaps, y, x), blend(turn.swaps, x, y), z);
}

// Boxes are a little larger than what they hold, by more than these operations round (rendering/stones/tree.py).
static inline void aim(vec3L origin, vec3L direction, probes_t *probes) {
  const real side = probes->side, widening = probes->widening;
  store3(origin, probes->origin);
  store3(direction, probes->direction);
  store_lanes(load_lanes(probes->start) - (SLACK + widening), probes->earliest);
  store3(scale3(splat(-side), direction), probes->facing);
  const vec3L inverse = vec3((real)1 / away_from_zero(direction.x), (real)1 / away_from_zero(direction.y),
                             (real)1 / away_from_zero(direction.z));
  store3(inverse, probes->inverse);
  const vec3L offset = vec3(-origin.x * inverse.x, -origin.y * inverse.y, -origin.z * inverse.z);
  const vec3L wider = scale3(splat(widening), vec3(fabs(inverse.x), fabs(inverse.y), fabs(inverse.z)));
  store3(vec3(offset.x - wider.x, offset.y - wider.y, offset.z - wider.z), probes->enter);
  store3(vec3(offset.x + wider.x, offset.y + wider.y, offset.z + wider.z), probes->leave);
  const intL upper[3] = {blend_ints_by(inverse.x < 0, (intL)(3), (intL)(0)),
                         blend_ints_by(inverse.y < 0, (intL)(3), (intL)(0)),
                         blend_ints_by(inverse.z < 0, (intL)(3), (intL)(0))};
  EACH (k, 3) {
    store_ints(TREE_WIDTH * (k + upper[k]), (int *)probes->first_side[k]);
    store_ints(TREE_WIDTH * (k + 3 - upper[k]), (int *)probes->last_side[k]);
    store_ints(TREE_WIDTH * (k + (side > 0 ? 6 + upper[k] : 9 - upper[k])), (int *)probes->most_facing[k]);
  }

  const realL x = fabs(direction.x), y = fabs(direction.y), z = fabs(direction.z);
  turnL turn;
  turn.along_x = (x > y) & (x > z);
  turn.along_y = !(x > y) & (y > z);
  turn.swaps = origin.x != origin.x;
  turn.swaps = side * turned(turn, direction).z > 0;
  const vec3L axis = turned(turn, vec3(splat(0), splat(1), splat(2))), way = turned(turn, direction);
  store_ints(TREE_WIDTH * reals_to_int(axis.x), (int *)probes->axis[0]);
  store_ints(TREE_WIDTH * reals_to_int(axis.y), (int *)probes->axis[1]);
  store_ints(TREE_WIDTH * reals_to_int(axis.z), (int *)probes->axis[2]);
  store3(turned(turn, origin), probes->turned);
  const realL step = turned(turn, inverse).z;
  store_lanes(step * way.x, probes->shear[0]);
  store_lanes(step * way.y, probes->shear[1]);
}

typedef struct {
  realW x, y, z;
} cornerW;

// A corner of each triangle as seen from the ray's start along the ray: the same numbers in every triangle that shares it.
static inline cornerW sheared(__global const real *rows, int corner, const probes_t *probes, int ray) {
  cornerW c;
  c.z = wide(rows + probes->axis[2][ray] + 3 * corner * TREE_WIDTH) - probes->turned[2][ray];
  c.x = fma((realW)(-probes->shear[0][ray]), c.z,
            wide(rows + probes->axis[0][ray] + 3 * corner * TREE_WIDTH) - probes->turned[0][ray]);
  c.y = fma((realW)(-probes->shear[1][ray]), c.z,
            wide(rows + probes->axis[1][ray] + 3 * corner * TREE_WIDTH) - probes->turned[1][ray]);
  return c;
}

// Twice a.x b.y - a.y b.x: on which side of an edge the ray passes. Rounding is monotonic, so written like this the result
// never has the wrong sign; it may be 0, and then the ray passes both neighbours. No ray slips between them.
static inline realW turn(cornerW a, cornerW b) { return fma(a.x, b.y, -(a.y * b.x)) - fma(a.y, b.x, -(a.x * b.y)); }

// Leaves or triangles, and the ray that looks at each: number x LANES + ray. All that one look adds are written at once, and
// counted as far as they are meant.
static inline void add(uint *to, int *count, uint bits, intW numbers) {
#if TREE_WIDTH == 16 && AVX512
  *(ints_anywhereW *)(to + *count) = __builtin_ia32_compresssi512_mask(numbers, numbers, bits);
  *count += popcount(bits);
#else
  uint number[TREE_WIDTH];
  *(ints_anywhereW *)number = numbers;
  for (; bits != 0; bits &= bits - 1) to[(*count)++] = number[lowest_bit(bits)];
#endif
}

// An edge's length as the ray sees it, from 1 to 1.4 times as much.
static inline realW length_about(cornerW a, cornerW b) { return fabs(a.x - b.x) + fabs(a.y - b.y); }

static inline maskW spans_zero(realW a, realW b, realW c, real margin) {
  return (fmin(fmin(a, b), c) <= margin) & (fmax(fmax(a, b), c) >= -margin);
}

// Nodes that are looked into beside each other, those of all rays together; when so many wait, one by one.
#define BESIDE 32
#define MANY_WAIT 1024
#define SOME_TRIANGLES 64 // so many at most wait, and those of a leaf

// What rays have still to look at, of all rays together.
typedef struct {
  uint node[MANY_WAIT + BESIDE * TREE_WIDTH + TREE_STACK + TREE_WIDTH];
  uint leaf[BESIDE * TREE_WIDTH + TREE_WIDTH];
  uint triangle[SOME_TRIANGLES + 2 * TREE_WIDTH];
  int nodes, leaves, triangles;
} waiting_t;

// Adds the triangles of a leaf through which a ray goes, from the right side: Woop, Benthin & Wald, Watertight Ray/Triangle
// Intersection (2013).
static inline void probe_leaf(tree_t tree, int leaf, const probes_t *probes, int ray, waiting_t *waiting) {
  __global const real *rows = tree.corners + leaf * 12 * TREE_WIDTH;
  const real widening = probes->widening;
  const cornerW a = sheared(rows, 0, probes, ray), b = sheared(rows, 1, probes, ray), c = sheared(rows, 2, probes, ray);
  const realW u = turn(b, c), v = turn(c, a), w = turn(a, b);
  maskW hits;
  if (widening == 0)
    hits = (fmin(fmin(u, v), w) >= 0) & (u + v + w > 0);
  else
    hits = (u >= -widening * length_about(b, c)) & (v >= -widening * length_about(c, a)) &
           (w >= -widening * length_about(a, b)) & spans_zero(a.x, b.x, c.x, widening) &
           spans_zero(a.y, b.y, c.y, widening);
  add(waiting->triangle, &waiting->triangles, mask_bits(hits), (leaf * TREE_WIDTH + PLACES) * LANES + ray);
}

// Takes up a triangle through which a ray goes, if it is nearer than what the ray has met. The distance is that to the facet's
// plane, so that the crossing is on it to rounding however the ray grazes it: the corner is seen along the ray, which has small
// numbers to round where the ray passes near it. Only facets that the ray meets from the right side count: one that it has just
// left is turned away and needs no epsilon.
static inline void take_triangle(tree_t tree, int triangle, probes_t *probes, int ray) {
  __global const real *rows = tree.corners + triangle / TREE_WIDTH * 12 * TREE_WIDTH + triangle % TREE_WIDTH;
  const uint x = probes->axis[0][ray], y = probes->axis[1][ray], z = probes->axis[2][ray];
  const real across = probes->shear[0][ray], up = probes->shear[1][ray], side = probes->side;
  const real depth = rows[z] - probes->turned[2][ray];
  const real right = fma(-across, depth, rows[x] - probes->turned[0][ray]),
             above = fma(-up, depth, rows[y] - probes->turned[1][ray]);
  const real nx = rows[9 * TREE_WIDTH + x], ny = rows[9 * TREE_WIDTH + y];
  const real slope = fma(nx, across, fma(ny, up, rows[9 * TREE_WIDTH + z]));
  const real speed = probes->facing[z / TREE_WIDTH][ray] * slope;
  const real gap = -side * fma(nx, right, fma(ny, above, slope * depth));
  // From outside, light that skims a facet to rounding passes it by: reflected, it would skim it again, without end.
  if (!(speed > (side > 0 ? SLACK : PARALLEL) && gap - probes->start[ray] * speed >= -SLACK - probes->widening)) return;
  const real t = (side < 0 ? fmax(gap, (real)SMALLEST_GAP) : gap) / speed;
  if (t < probes->limit[ray]) {
    probes->limit[ray] = t;
    probes->triangle[ray] = triangle;
  }
}

// Adds the children of a node into whose boxes a ray goes, in any order: to sort them costs more than it saves.
static inline void probe_node(tree_t tree, int node, const probes_t *probes, int ray, waiting_t *waiting) {
  __global const real *rows = tree.boxes + node * 12 * TREE_WIDTH;
  realW near = (realW)(probes->earliest[ray]), far = (realW)(probes->limit[ray]), facing = (realW)(0);
  EACH (k, 3) {
    const realW inverse = (realW)(probes->inverse[k][ray]);
    near = fmax(near, fma(wide(rows + probes->first_side[k][ray]), inverse, (realW)(probes->enter[k][ray])));
    far = fmin(far, fma(wide(rows + probes->last_side[k][ray]), inverse, (realW)(probes->leave[k][ray])));
    facing = fma(wide(rows + probes->most_facing[k][ray]), (realW)(probes->facing[k][ray]), facing);
  }
  const uint entered = mask_bits((near <= far) & (facing > 0));
  const intW links = *(__global const ints_anywhereW *)(tree.links + node * TREE_WIDTH);
  const uint leaves = entered & mask_bits(JOIN(JOIN(convert_, MASK), TREE_WIDTH)(links < 0));
  add(waiting->node, &waiting->nodes, entered ^ leaves, links * LANES + ray);
  add(waiting->leaf, &waiting->leaves, leaves, ~links * LANES + ray);
}

// The nearest triangle along each ray that the mask names. Rays go through the tree beside each other: while one waits for what it
// compares, the processor goes on with the next.
static inline void probe_tree(tree_t tree, int root, maskL mask, probes_t *probes) {
  waiting_t waiting;
  const packing_t packing = packing_of(mask);
  pack_ints(packing, root * LANES + LANE_INDEX, (int *)waiting.node);
  waiting.nodes = packing.count;
  while (waiting.nodes > 0) {
    const int count = waiting.nodes > MANY_WAIT ? 1 : min(waiting.nodes, BESIDE);
    uint node[BESIDE];
    waiting.nodes -= count;
    EACH (k, BESIDE / TREE_WIDTH)
      *(ints_anywhereW *)(node + k * TREE_WIDTH) = *(ints_anywhereW *)(waiting.node + waiting.nodes + k * TREE_WIDTH);
    waiting.leaves = 0;
    for (int i = 0; i < count; i++) probe_node(tree, node[i] / LANES, probes, node[i] % LANES, &waiting);
    for (int first = 0; first < waiting.leaves;) {
      waiting.triangles = 0;
      for (; first < waiting.leaves && waiting.triangles < SOME_TRIANGLES; first++)
        probe_leaf(tree, waiting.leaf[first] / LANES, probes, waiting.leaf[first] % LANES, &waiting);
      for (int i = 0; i < waiting.triangles; i++)
        take_triangle(tree, waiting.triangle[i] / LANES, probes, waiting.triangle[i] % LANES);
    }
  }
}

// Cosine to a facet below which rounding of the ray's start moves the crossing by more than 1e-5 R along the ray.
#define GRAZING (100000 * SMALLEST_GAP)

static inline real dot_real(const real a[3], const real b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Where a ray that grazes a facet crosses it: where it does so to rounding, but while it is abreast of the triangle.
static inline real abreast(__global const real *rows, const probes_t *probes, int ray) {
  real normal[3], origin[3], direction[3], enter = -1e30f, leave = 1e30f, first = 1e30f, last = -1e30f;
  for (int k = 0; k < 3; k++) {
    normal[k] = rows[(9 + k) * TREE_WIDTH];
    origin[k] = probes->origin[k][ray];
    direction[k] = probes->direction[k][ray];
  }
  const int longest = probes->axis[2][ray] / TREE_WIDTH;
  for (int corner = 0; corner < 3; corner++) {
    real from[3], edge[3];
    for (int k = 0; k < 3; k++) {
      from[k] = rows[(3 * corner + k) * TREE_WIDTH];
      edge[k] = rows[(3 * ((corner + 1) % 3) + k) * TREE_WIDTH] - from[k];
      from[k] -= origin[k];
    }
    const real outward[3] = {edge[1] * normal[2] - edge[2] * normal[1], edge[2] * normal[0] - edge[0] * normal[2],
                             edge[0] * normal[1] - edge[1] * normal[0]};
    const real margin = 2 * (SLACK + probes->widened[ray]) * (fabs(edge[0]) + fabs(edge[1]) + fabs(edge[2]));
    const real speed = dot_real(outward, direction);
    const real t = (dot_real(outward, from) + margin) / (fabs(speed) < PARALLEL ? copysign(PARALLEL, speed) : speed);
    enter = speed < 0 ? fmax(enter, t) : enter;
    leave = speed > 0 ? fmin(leave, t) : leave;
    const real depth = from[longest] / direction[longest];
    first = fmin(first, depth);
    last = fmax(last, depth);
  }
  return clamp(fmax(enter, fmin(probes->limit[ray], leave)), first, last);
}

// The nearest crossing of each lane's ray between t_min and t_max, from outside (side 1) or from inside (side -1).
static inline crossingL mesh_crossing(__constant const stone_t *stone, tree_t tree, vec3L origin, vec3L direction,
                                      realL t_min, real t_max, maskL mask, real side) {
  const vec3L from = into_axes(stone->axes, origin), towards = into_axes(stone->axes, direction);
  probes_t probes;
  store_lanes(t_min, probes.start);
  store_lanes(splat(t_max), probes.limit);
  store_ints((intL)(-1), probes.triangle);
  probes.side = side;
  probes.widening = 0;
  store_lanes(splat(0), probes.widened);
  maskL open = mask, found;
  for (;;) {
    aim(from, towards, &probes);
    probe_tree(tree, stone->root, open, &probes);
    store_lanes(blend(open, splat(probes.widening), load_lanes(probes.widened)), probes.widened);
    found = mask & widen(load_ints(probes.triangle) >= (intL)(0));
    open = mask & !found;
    if (side > 0 || !any_lane(open) || probes.widening >= LAST_WIDENING) break;
    probes.widening = fmax(FIRST_WIDENING, WIDER * probes.widening);
  }
  real t[LANES], normal[3][LANES];
  for (int lane = 0; lane < LANES; lane++) {
    const int triangle = probes.triangle[lane] < 0 ? 0 : probes.triangle[lane]; // the first leaf is empty: zeros
    __global const real *corners = tree.corners + triangle / TREE_WIDTH * 12 * TREE_WIDTH + triangle % TREE_WIDTH;
    EACH (k, 3) normal[k][lane] = corners[(9 + k) * TREE_WIDTH];
  }
  store_lanes(load_lanes(probes.limit), t);
  const maskL grazing = found & (fabs(dot3(load3(normal), towards)) <= (real)GRAZING);
  if (any_lane(grazing)) {
    int grazes[LANES];
    store_mask(grazing, grazes);
    for (int lane = 0; lane < LANES; lane++) {
      if (!grazes[lane]) continue;
      const int triangle = probes.triangle[lane];
      t[lane] = abreast(tree.corners + triangle / TREE_WIDTH * 12 * TREE_WIDTH + triangle % TREE_WIDTH, &probes, lane);
    }
  }
  const crossingL crossing = {found, blend(found, fmax(load_lanes(t), t_min), splat(0)),
                              out_of_axes(stone->axes, load3(normal))};
  return crossing;
}

#endif
