// A stone that is not convex: triangles in a tree of boxes, in the stone's own axes.
//
// Rays inside such a stone scatter, so a packet of them shares no way through the tree. The packet is of boxes instead:
// one ray is tested against all children of a node at once, and against all triangles of a leaf. The host makes the tree
// (rendering/tree.py) and sees to it that the stack suffices.
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
static inline realW load_wide(__global const real *from, int row) { return JOIN(vload, TREE_WIDTH)(row, from); }

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

typedef struct {
  real origin[3], direction[3], inverse[3];
  int axis[3];   // z is the direction's longest; x and y are so that triangles that count turn left
  real shear[2]; // how far the ray goes along x and y for each step along z
  real start;    // hits before this do not count,
  real limit;    // nor do those behind this; becomes the nearest hit
  real widening; // of triangles, R
  int triangle;  // leaf x TREE_WIDTH + place, -1 for none
} probe_t;

static inline realL away_from_zero(realL x) { return blend(fabs(x) < PARALLEL, copysign(splat(PARALLEL), x), x); }

// What probes need of a packet of rays, one row a quantity: origin, direction and its inverse, the start, and how the ray
// is sheared onto its longest axis.
#define PROBE_ROWS 13
static inline void aim(vec3L origin, vec3L direction, realL start, real side, real rows[PROBE_ROWS][LANES]) {
  const realL x = fabs(direction.x), y = fabs(direction.y), z = fabs(direction.z);
  const maskL along_x = (x > y) & (x > z), along_y = !(x > y) & (y > z);
  const vec3L turned = vec3(blend(along_x, direction.y, blend(along_y, direction.z, direction.x)),
                            blend(along_x, direction.z, blend(along_y, direction.x, direction.y)),
                            blend(along_x, direction.x, blend(along_y, direction.y, direction.z)));
  const vec3L inverse = vec3((real)1 / away_from_zero(direction.x), (real)1 / away_from_zero(direction.y),
                             (real)1 / away_from_zero(direction.z));
  const realL longest = blend(along_x, inverse.x, blend(along_y, inverse.y, inverse.z));
  store3(origin, rows);
  store3(direction, rows + 3);
  store3(inverse, rows + 6);
  store_lanes(start, rows[9]);
  const maskL swaps = side * turned.z > 0;
  store_lanes(longest * blend(swaps, turned.y, turned.x), rows[10]);
  store_lanes(longest * blend(swaps, turned.x, turned.y), rows[11]);
  const realL axis = blend(along_x, splat(0), blend(along_y, splat(1), splat(2)));
  store_lanes(axis + blend(swaps, splat(3), splat(0)), rows[12]);
}

static inline probe_t probe_of(real rows[PROBE_ROWS][LANES], int lane, real limit) {
  const int axis = rows[12][lane], z = axis >= 3 ? axis - 3 : axis, next = z == 2 ? 0 : z + 1, last = 3 - z - next;
  probe_t probe;
  EACH (k, 3) {
    probe.origin[k] = rows[k][lane];
    probe.direction[k] = rows[3 + k][lane];
    probe.inverse[k] = rows[6 + k][lane];
  }
  probe.start = rows[9][lane];
  EACH (k, 2) probe.shear[k] = rows[10 + k][lane];
  probe.axis[0] = axis >= 3 ? last : next;
  probe.axis[1] = axis >= 3 ? next : last;
  probe.axis[2] = z;
  probe.limit = limit;
  probe.widening = 0;
  probe.triangle = -1;
  return probe;
}

typedef struct {
  realW x, y, z;
} cornerW;

// A corner of each triangle as seen from the ray's start along the ray: the same numbers in every triangle that shares it.
static inline cornerW sheared(__global const real *rows, int corner, const probe_t *probe) {
  cornerW c;
  c.z = load_wide(rows, 3 * corner + probe->axis[2]) - probe->origin[probe->axis[2]];
  c.x =
      fma((realW)(-probe->shear[0]), c.z, load_wide(rows, 3 * corner + probe->axis[0]) - probe->origin[probe->axis[0]]);
  c.y =
      fma((realW)(-probe->shear[1]), c.z, load_wide(rows, 3 * corner + probe->axis[1]) - probe->origin[probe->axis[1]]);
  return c;
}

// Twice a.x b.y - a.y b.x: on which side of an edge the ray passes. Rounding is monotonic, so written like this the result
// never has the wrong sign; it may be 0, and then the ray passes both neighbours. No ray slips between them.
static inline realW turn(cornerW a, cornerW b) { return fma(a.x, b.y, -(a.y * b.x)) - fma(a.y, b.x, -(a.x * b.y)); }

// An edge's length as the ray sees it, from 1 to 1.4 times as much.
static inline realW length_about(cornerW a, cornerW b) { return fabs(a.x - b.x) + fabs(a.y - b.y); }

static inline maskW spans_zero(realW a, realW b, realW c, real margin) {
  return (fmin(fmin(a, b), c) <= margin) & (fmax(fmax(a, b), c) >= -margin);
}

// Woop, Benthin & Wald, Watertight Ray/Triangle Intersection (2013). Only facets that the ray meets from the right side count
// (side 1: from outside, -1: from inside): one that it has just left is turned away and needs no epsilon. The distance is
// that to the facet's plane, so that the crossing is on it to rounding however the ray grazes it.
static inline void probe_leaf(tree_t tree, int leaf, real side, probe_t *probe) {
  __global const real *rows = tree.corners + leaf * 12 * TREE_WIDTH;
  const cornerW a = sheared(rows, 0, probe), b = sheared(rows, 1, probe), c = sheared(rows, 2, probe);
  const realW u = turn(b, c), v = turn(c, a), w = turn(a, b);
  maskW hits;
  if (probe->widening == 0)
    hits = (fmin(fmin(u, v), w) >= 0) & (u + v + w > 0);
  else
    hits = (u >= -probe->widening * length_about(b, c)) & (v >= -probe->widening * length_about(c, a)) &
           (w >= -probe->widening * length_about(a, b)) & spans_zero(a.x, b.x, c.x, probe->widening) &
           spans_zero(a.y, b.y, c.y, probe->widening);
  const realW nx = load_wide(rows, 9 + probe->axis[0]), ny = load_wide(rows, 9 + probe->axis[1]),
              nz = load_wide(rows, 9 + probe->axis[2]);
  const realW slope = fma(nx, (realW)(probe->shear[0]), fma(ny, (realW)(probe->shear[1]), nz));
  const realW speed = -side * probe->direction[probe->axis[2]] * slope;
  const realW gap = -side * fma(nx, a.x, fma(ny, a.y, slope * a.z));
  // From outside, light that skims a facet to rounding passes it by: reflected, it would skim it again, without end.
  hits &= (speed > (side > 0 ? SLACK : PARALLEL)) & (gap - probe->start * speed >= -SLACK - probe->widening);
  const realW t = (side < 0 ? fmax(gap, (realW)(SMALLEST_GAP)) : gap) / fmax(speed, (realW)(PARALLEL));
  uint hit = mask_bits(hits & (t < probe->limit));
  if (hit == 0) return;
  real distance[TREE_WIDTH];
  JOIN(vstore, TREE_WIDTH)(t, 0, distance);
  for (; hit != 0; hit &= hit - 1) {
    const int place = lowest_bit(hit);
    if (distance[place] < probe->limit) {
      probe->limit = distance[place];
      probe->triangle = leaf * TREE_WIDTH + place;
    }
  }
}

// Nodes that wait to be looked into, and how far along the ray their boxes are. All children of a node are written at
// once, and counted as far as they are meant.
typedef struct {
  int node[TREE_STACK + TREE_WIDTH];
  real nearness[TREE_STACK + TREE_WIDTH];
  int size;
} stack_t;

// Adds the children that the bits name, in any order: to sort them costs more than it saves.
static inline void put(stack_t *stack, uint bits, __global const int *links, realW near) {
#if TREE_WIDTH == 16 && AVX512
  const int16 nodes = vload16(0, links);
  vstore16(__builtin_ia32_compresssi512_mask(nodes, nodes, bits), 0, stack->node + stack->size);
  vstore16(__builtin_ia32_compresssf512_mask(near, near, bits), 0, stack->nearness + stack->size);
  stack->size += popcount(bits);
#else
  real nearness[TREE_WIDTH];
  JOIN(vstore, TREE_WIDTH)(near, 0, nearness);
  for (; bits != 0; bits &= bits - 1) {
    const int child = lowest_bit(bits);
    stack->node[stack->size] = links[child];
    stack->nearness[stack->size++] = nearness[child];
  }
#endif
}

// The nearest triangle along a ray.
static inline void probe_tree(tree_t tree, int root, real side, probe_t *probe) {
  stack_t stack;
  stack.size = 1;
  stack.node[0] = root;
  stack.nearness[0] = probe->start;
  // Along each axis a box is entered at one of its two sides and left at the other, by the direction's sign. Boxes are a
  // little larger than what they hold, by more than these operations round (rendering/tree.py).
  real enter[3], leave[3];
  int first_side[3];
  // Of the normals in a box the component that faces the ray most, or, inside, is turned away most.
  int most_facing[3];
  for (int k = 0; k < 3; k++) {
    const real inverse = probe->inverse[k];
    const real offset = -probe->origin[k] * inverse, widening = probe->widening * fabs(inverse);
    enter[k] = offset - widening;
    leave[k] = offset + widening;
    first_side[k] = inverse < 0 ? 3 + k : k;
    most_facing[k] = side * probe->direction[k] < 0 ? 9 + k : 6 + k;
  }
  while (stack.size > 0) {
    stack.size--;
    if (stack.nearness[stack.size] > probe->limit) continue;
    const int node = stack.node[stack.size];
    if (node < 0) {
      probe_leaf(tree, ~node, side, probe);
      continue;
    }
    __global const real *rows = tree.boxes + node * 12 * TREE_WIDTH;
    realW near = (realW)(probe->start - SLACK - probe->widening), far = (realW)(probe->limit), facing = (realW)(0);
    for (int k = 0; k < 3; k++) {
      facing = fma(load_wide(rows, most_facing[k]), (realW)(-side * probe->direction[k]), facing);
      near = fmax(near, fma(load_wide(rows, first_side[k]), (realW)(probe->inverse[k]), (realW)(enter[k])));
      far = fmin(far, fma(load_wide(rows, 3 + 2 * k - first_side[k]), (realW)(probe->inverse[k]), (realW)(leave[k])));
    }
    const uint entered = mask_bits((near <= far) & (facing > 0));
    if (entered != 0) put(&stack, entered, tree.links + node * TREE_WIDTH, near);
  }
}

// Cosine to a facet below which rounding of the ray's start moves the crossing by more than 1e-5 R along the ray.
#define GRAZING (100000 * SMALLEST_GAP)

static inline real dot_real(const real a[3], const real b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Where a ray that grazes a facet crosses it: where it does so to rounding, but while it is abreast of the triangle.
static inline real abreast(__global const real *rows, const probe_t *probe) {
  real normal[3], enter = -1e30f, leave = 1e30f, first = 1e30f, last = -1e30f;
  for (int k = 0; k < 3; k++) normal[k] = rows[(9 + k) * TREE_WIDTH];
  if (fabs(dot_real(normal, probe->direction)) > GRAZING) return probe->limit;
  for (int corner = 0; corner < 3; corner++) {
    real from[3], edge[3];
    for (int k = 0; k < 3; k++) {
      from[k] = rows[(3 * corner + k) * TREE_WIDTH];
      edge[k] = rows[(3 * ((corner + 1) % 3) + k) * TREE_WIDTH] - from[k];
      from[k] -= probe->origin[k];
    }
    const real outward[3] = {edge[1] * normal[2] - edge[2] * normal[1], edge[2] * normal[0] - edge[0] * normal[2],
                             edge[0] * normal[1] - edge[1] * normal[0]};
    const real margin = 2 * (SLACK + probe->widening) * (fabs(edge[0]) + fabs(edge[1]) + fabs(edge[2]));
    const real speed = dot_real(outward, probe->direction);
    const real t = (dot_real(outward, from) + margin) / (fabs(speed) < PARALLEL ? copysign(PARALLEL, speed) : speed);
    enter = speed < 0 ? fmax(enter, t) : enter;
    leave = speed > 0 ? fmin(leave, t) : leave;
    const real depth = from[probe->axis[2]] / probe->direction[probe->axis[2]];
    first = fmin(first, depth);
    last = fmax(last, depth);
  }
  return clamp(fmax(enter, fmin(probe->limit, leave)), first, last);
}

// The nearest crossing of each lane's ray between t_min and t_max, from outside (side 1) or from inside (side -1).
static inline crossingL mesh_crossing(__constant const stone_t *stone, tree_t tree, vec3L origin, vec3L direction,
                                      realL t_min, real t_max, maskL mask, real side) {
  int wanted[LANES];
  real rows[PROBE_ROWS][LANES], t[LANES], normal[3][LANES];
  store_mask(mask, wanted);
  aim(into_axes(stone->axes, origin), into_axes(stone->axes, direction), t_min, side, rows);
  for (int lane = 0; lane < LANES; lane++) {
    t[lane] = -1e30f;
    EACH (k, 3) normal[k][lane] = 0;
    if (!wanted[lane]) continue;
    probe_t probe = probe_of(rows, lane, t_max);
    probe_tree(tree, stone->root, side, &probe);
    while (side < 0 && probe.triangle < 0 && probe.widening < LAST_WIDENING) {
      probe.widening = fmax(FIRST_WIDENING, WIDER * probe.widening);
      probe_tree(tree, stone->root, side, &probe);
    }
    if (probe.triangle < 0) continue;
    __global const real *corners =
        tree.corners + probe.triangle / TREE_WIDTH * 12 * TREE_WIDTH + probe.triangle % TREE_WIDTH;
    t[lane] = fmax(abreast(corners, &probe), probe.start);
    EACH (k, 3) normal[k][lane] = corners[(9 + k) * TREE_WIDTH];
  }
  const realL found = load_lanes(t);
  const maskL hit = mask & (found > (real)-1e29);
  const crossingL crossing = {hit, blend(hit, found, splat(0)), out_of_axes(stone->axes, load3(normal))};
  return crossing;
}

#endif
