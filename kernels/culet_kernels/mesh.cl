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
#if TREE_WIDTH == 16
  const uchar16 bytes = as_uchar16(convert_char16(mask));
  return byte_bits(bytes.lo) | byte_bits(bytes.hi) << 8;
#else
  return byte_bits(as_uchar8(convert_char8(mask)));
#endif
}
static inline int lowest_bit(uint bits) { return popcount((bits & -bits) - 1); }

// Part of a triangle's extent, or of R along a ray, within which rounding may place a hit on the wrong side of an edge or
// of the ray's start. Neighbours overlap by this much, which closes the cracks between them.
#if IS_DOUBLE
#define OVERLAP 1e-12
#define WIDE_OVERLAP 1e-9
#else
#define OVERLAP 2e-6f
#define WIDE_OVERLAP                                                                                                   \
  1e-4f // for a ray inside that has found nothing, which no ray inside can: it is at an edge or a vertex
#endif

typedef struct {
  // For each node the children's boxes and those of their normals: lower x, y, z and upper x, y, z, TREE_WIDTH of each.
  __global const real *boxes;
  __global const int *links;    // for each child the node, or ~leaf
  __global const real *corners; // for each leaf one corner, two edges and the facet's normal, TREE_WIDTH of each
} tree_t;

typedef struct {
  real origin[3], direction[3];
  real start;   // hits before this do not count,
  real overlap;
  real limit;   // nor do those behind this; becomes the nearest hit
  int triangle; // leaf x TREE_WIDTH + place, -1 for none
} probe_t;

// Moller & Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997). Only triangles that the ray meets from the
// right side count (side 1: from outside, -1: from inside): one that it has just left is turned away and needs no epsilon.
static inline void probe_leaf(tree_t tree, int leaf, real side, probe_t *probe) {
  __global const real *rows = tree.corners + leaf * 12 * TREE_WIDTH;
  const realW dx = (realW)(probe->direction[0]), dy = (realW)(probe->direction[1]), dz = (realW)(probe->direction[2]);
  const realW ax = load_wide(rows, 3), ay = load_wide(rows, 4), az = load_wide(rows, 5);
  const realW bx = load_wide(rows, 6), by = load_wide(rows, 7), bz = load_wide(rows, 8);
  const realW px = dy * bz - dz * by, py = dz * bx - dx * bz, pz = dx * by - dy * bx;
  const realW det = ax * px + ay * py + az * pz;
  const maskW faces = side * det > (real)1e-30;
  const realW inverse = (real)1 / select((realW)(1), det, faces);
  const realW tx = probe->origin[0] - load_wide(rows, 0), ty = probe->origin[1] - load_wide(rows, 1),
              tz = probe->origin[2] - load_wide(rows, 2);
  const realW u = (tx * px + ty * py + tz * pz) * inverse;
  const realW qx = ty * az - tz * ay, qy = tz * ax - tx * az, qz = tx * ay - ty * ax;
  const realW v = (dx * qx + dy * qy + dz * qz) * inverse;
  const realW t = (bx * qx + by * qy + bz * qz) * inverse;
  const maskW hits = faces & (u >= -probe->overlap) & (v >= -probe->overlap) & (u + v <= 1 + probe->overlap) &
                     (t >= probe->start - probe->overlap) & (t < probe->limit);
  uint hit = mask_bits(hits);
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

static inline real away_from_zero(real x) { return fabs(x) < PARALLEL ? copysign(PARALLEL, x) : x; }

// The nearest triangle along a ray.
static inline void probe_tree(tree_t tree, real side, probe_t *probe) {
  int stack[TREE_STACK];
  real nearness[TREE_STACK];
  int size = 1;
  stack[0] = 0;
  nearness[0] = probe->start;
  // Along each axis a box is entered at one of its two sides and left at the other, by the direction's sign. Boxes are a
  // little larger than what they hold, by more than these operations round (rendering/tree.py).
  real inverse[3], enter[3], leave[3];
  int first_side[3];
  // Of the normals in a box the component that faces the ray most, or, inside, is turned away most.
  int most_facing[3];
  for (int k = 0; k < 3; k++) {
    inverse[k] = 1 / away_from_zero(probe->direction[k]);
    const real offset = -probe->origin[k] * inverse[k], widening = (probe->overlap - OVERLAP) * fabs(inverse[k]);
    enter[k] = offset - widening;
    leave[k] = offset + widening;
    first_side[k] = inverse[k] < 0 ? 3 + k : k;
    most_facing[k] = side * probe->direction[k] < 0 ? 9 + k : 6 + k;
  }
  while (size > 0) {
    size--;
    if (nearness[size] > probe->limit) continue;
    const int node = stack[size];
    if (node < 0) {
      probe_leaf(tree, ~node, side, probe);
      continue;
    }
    __global const real *rows = tree.boxes + node * 12 * TREE_WIDTH;
    realW near = (realW)(probe->start - probe->overlap), far = (realW)(probe->limit), facing = (realW)(0);
    for (int k = 0; k < 3; k++) {
      facing = fma(load_wide(rows, most_facing[k]), (realW)(-side * probe->direction[k]), facing);
      near = fmax(near, fma(load_wide(rows, first_side[k]), (realW)(inverse[k]), (realW)(enter[k])));
      far = fmin(far, fma(load_wide(rows, 3 + 2 * k - first_side[k]), (realW)(inverse[k]), (realW)(leave[k])));
    }
    uint entered = mask_bits((near <= far) & (facing > 0));
    if (entered == 0) continue;
    real distance[TREE_WIDTH];
    JOIN(vstore, TREE_WIDTH)(near, 0, distance);
    const int base = size;
    for (; entered != 0; entered &= entered - 1) {
      const int child = lowest_bit(entered);
      int place = size++; // sorted, the nearest on top
      for (; place > base && nearness[place - 1] < distance[child]; place--) {
        stack[place] = stack[place - 1];
        nearness[place] = nearness[place - 1];
      }
      stack[place] = tree.links[node * TREE_WIDTH + child];
      nearness[place] = distance[child];
    }
  }
}

static inline vec3L to_stone(__constant const parameters_t *scene, vec3L v) {
  return vec3(v.x * scene->axes[0][0] + v.y * scene->axes[1][0] + v.z * scene->axes[2][0],
              v.x * scene->axes[0][1] + v.y * scene->axes[1][1] + v.z * scene->axes[2][1],
              v.x * scene->axes[0][2] + v.y * scene->axes[1][2] + v.z * scene->axes[2][2]);
}

static inline vec3L to_world(__constant const parameters_t *scene, vec3L v) {
  return vec3(v.x * scene->axes[0][0] + v.y * scene->axes[0][1] + v.z * scene->axes[0][2],
              v.x * scene->axes[1][0] + v.y * scene->axes[1][1] + v.z * scene->axes[1][2],
              v.x * scene->axes[2][0] + v.y * scene->axes[2][1] + v.z * scene->axes[2][2]);
}

// The nearest crossing of each lane's ray between t_min and t_max, from outside (side 1) or from inside (side -1).
static inline crossingL mesh_crossing(__constant const parameters_t *scene, tree_t tree, vec3L origin, vec3L direction,
                                      realL t_min, real t_max, maskL mask, real side) {
  const vec3L o = to_stone(scene, origin), d = to_stone(scene, direction);
  int wanted[LANES];
  real quantity[7][LANES], t[LANES], normal[3][LANES];
  store_mask(mask, wanted);
  store_lanes(o.x, quantity[0]);
  store_lanes(o.y, quantity[1]);
  store_lanes(o.z, quantity[2]);
  store_lanes(d.x, quantity[3]);
  store_lanes(d.y, quantity[4]);
  store_lanes(d.z, quantity[5]);
  store_lanes(t_min, quantity[6]);
  for (int lane = 0; lane < LANES; lane++) {
    t[lane] = -1e30f;
    normal[0][lane] = normal[1][lane] = normal[2][lane] = 0;
    if (!wanted[lane]) continue;
    probe_t probe;
    for (int k = 0; k < 3; k++) {
      probe.origin[k] = quantity[k][lane];
      probe.direction[k] = quantity[3 + k][lane];
    }
    probe.start = quantity[6][lane];
    probe.limit = t_max;
    probe.triangle = -1;
    probe.overlap = OVERLAP;
    probe_tree(tree, side, &probe);
    if (probe.triangle < 0 && side < 0) {
      probe.overlap = WIDE_OVERLAP;
      probe_tree(tree, side, &probe);
    }
    if (probe.triangle < 0) continue;
    t[lane] = fmax(probe.limit, probe.start);
    __global const real *rows =
        tree.corners + (probe.triangle / TREE_WIDTH * 12 + 9) * TREE_WIDTH + probe.triangle % TREE_WIDTH;
    for (int k = 0; k < 3; k++) normal[k][lane] = rows[k * TREE_WIDTH];
  }
  const realL found = load_lanes(t);
  const maskL hit = mask & (found > (real)-1e29);
  const crossingL crossing = {
      hit, blend(hit, found, splat(0)),
      to_world(scene, vec3(load_lanes(normal[0]), load_lanes(normal[1]), load_lanes(normal[2])))};
  return crossing;
}

#endif
