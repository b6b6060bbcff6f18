// Where light inside a convex stone leaves, by the symmetry of its facets.
//
// Light inside is followed in axes of the stone in which most facets are images of each other by sign: four are (+-x, y, +-z),
// two are (x, y, z) and (-x, y, -z), or (+-x, y, z). How fast a ray nears each of them, and how far away each is, are sums of the
// same products with other signs, and signs alone tell which of them it reaches first. A row stands for four facets, for two
// or for one (rendering/facet_rows.py).
#ifndef CULET_FACET_ROWS
#define CULET_FACET_ROWS
#include "hull.cl"

// Kinds of row, in their order: of four facets, two rows each of the same y and offset; of four; of two by a half turn about y;
// of two by a mirror across x; of one. Those of two facets or four are even in number.
#define TIERS 0
#define FOURS 1
#define TURNED_TWOS 2
#define MIRRORED_TWOS 3
#define ONES 4
#define COLUMN_ROWS 32 // rows up to which a stone's are in columns too

typedef struct {
  __global const real4 *farther; // normals and offsets: the latter are a hair too large, so that no gap is negative,
  __global const real4 *exact;   // and as they are;
  __global const real *columns;  // the same by number: all x, all y, all z, all offsets
  __constant const int *end;     // of each kind
} rows_t;

static inline rows_t rows_of(__global const real4 *rows, __constant const int *end) {
  const int count = end[ONES];
  const rows_t of = {rows, rows + count, (__global const real *)(rows + 2 * count), end};
  return of;
}

// Each lane's row, by its number.
typedef struct {
  vec3L normal;
  realL offset;
} rowL;

static inline rowL row_at(rows_t rows, realL number) {
  const intL at = reals_to_int(number);
  rowL row;
#if LANES == 16 && AVX512
  if (rows.end[ONES] <= COLUMN_ROWS) { // the processor looks up what it has in registers
    realL component[4];
    EACH (k, 4) {
      __global const anywhereL *column = (__global const anywhereL *)(rows.columns + k * COLUMN_ROWS);
      component[k] = __builtin_ia32_vpermi2varps512(column[0], at, column[1]);
    }
    row.normal = vec3(component[0], component[1], component[2]);
    row.offset = component[3];
    return row;
  }
#endif
  int place[LANES];
  real component[4][LANES];
  store_ints(at, place);
  for (int lane = 0; lane < LANES; lane++) {
    const real4 own = rows.exact[place[lane]];
    component[0][lane] = own.x;
    component[1][lane] = own.y;
    component[2][lane] = own.z;
    component[3][lane] = own.w;
  }
  row.normal = load3(component);
  row.offset = load_lanes(component[3]);
  return row;
}

// The facet that a ray inside reaches first, of some: it nears it by `speed` per length and is `gap` away; the number of its row.
typedef struct {
  realL speed, gap, row;
} reachL;

static inline reachL reached(reachL first, realL speed, realL gap, realL row) {
  const maskL sooner = speed * first.gap > first.speed * gap;
  const reachL now = {blend(sooner, speed, first.speed), blend(sooner, gap, first.gap), blend(sooner, row, first.row)};
  return now;
}

// Of two facets, whose speeds are y + p and y - p and whose gaps are v - r and v + r, the first is reached first where
// (y + p) (v + r) > (y - p) (v - r), which is where this is positive.
static inline realL sign_of_two(realL y, realL v, realL p, realL r) { return fma(y, r, p * v); }

static inline reachL reached_of_two(reachL first, realL y, realL v, realL p, realL r, realL row) {
  const realL sign = sign_of_two(y, v, p, r);
  return reached(first, y + flip(p, sign), v - flip(r, sign), row);
}

// Of four facets of normals (s x, y, t z), where s and t are signs and x and z positive, at a ray o + l d: the speed is
// Y + s x d.x + t z d.z and the gap is V - s x o.x - t z o.z. Of two that differ in s the one with s = 1 is reached first where
// A - t z C is positive, of two that differ in t the one with t = 1 where B + s x C is:
//   Y = y d.y, V = offset - y o.y, A = d.x V + o.x Y, B = d.z V + o.z Y, C = d.x o.z - d.z o.x.
// So where |A| > z |C| s is the sign of A; elsewhere |B| > x |C|, since one of the four is the first: t is the sign of B.
typedef struct {
  realL y, v, a, b;
} tierL;

static inline tierL tier_of(vec3L o, vec3L d, realL normal_y, realL offset) {
  tierL tier;
  tier.y = d.y * normal_y;
  tier.v = fma(-o.y, normal_y, offset);
  tier.a = fma(d.x, tier.v, o.x * tier.y);
  tier.b = fma(d.z, tier.v, o.z * tier.y);
  return tier;
}

typedef struct {
  realL x, z;
} signsL;

static inline signsL signs_of_four(tierL tier, realL c, realL normal_x, realL normal_z) {
  const maskL x_first = fabs(tier.a) > normal_z * fabs(c);
  const signsL signs = {blend(x_first, tier.a, opposite(tier.b, c)),
                        blend(x_first, fma(flip(c, tier.a), normal_x, tier.b), tier.b)};
  return signs;
}

static inline reachL reached_of_four(reachL first, vec3L o, vec3L d, tierL tier, realL c, real4 facet, realL row) {
  const signsL signs = signs_of_four(tier, c, splat(facet.x), splat(facet.z));
  return reached(first, tier.y + flip(d.x * facet.x, signs.x) + flip(d.z * facet.z, signs.z),
                 tier.v - flip(o.x * facet.x, signs.x) - flip(o.z * facet.z, signs.z), row);
}

static inline reachL reached_of_one(reachL first, vec3L o, vec3L d, real4 facet, realL row) {
  return reached(first, dot_uniform(d, facet),
                 fma(-o.x, splat(facet.x), fma(-o.y, splat(facet.y), fma(-o.z, splat(facet.z), splat(facet.w)))), row);
}

// Rows that are looked at beside each other: a comparison waits for the one before it, those of other rows do not.
#define ROWS_ABREAST 4

// Where a ray inside leaves, in the axes of the rows.
__attribute__((always_inline)) static inline crossingL rows_exit(rows_t rows, vec3L o, vec3L d) {
  reachL first[ROWS_ABREAST];
  EACH (k, ROWS_ABREAST) {
    first[k].speed = first[k].row = splat(0);
    first[k].gap = splat(1);
  }
  const realL c = fma(d.x, o.z, -(d.z * o.x));
  realL row = splat(0);
  int i = 0;
  for (; i < rows.end[TIERS]; i += 2, row += 2) {
    const tierL tier = tier_of(o, d, splat(rows.farther[i].y), splat(rows.farther[i].w));
    EACH (k, 2) first[k] = reached_of_four(first[k], o, d, tier, c, rows.farther[i + k], row + k);
  }
  for (; i < rows.end[FOURS]; i += 2, row += 2)
    EACH (k, 2) {
      const real4 facet = rows.farther[i + k];
      first[k] = reached_of_four(first[k], o, d, tier_of(o, d, splat(facet.y), splat(facet.w)), c, facet, row + k);
    }
  for (; i < rows.end[TURNED_TWOS]; i += 2, row += 2)
    EACH (k, 2) {
      const real4 f = rows.farther[i + k];
      first[2 + k] = reached_of_two(first[2 + k], d.y * f.y, fma(-o.y, splat(f.y), splat(f.w)),
                                    fma(d.x, splat(f.x), d.z * f.z), fma(o.x, splat(f.x), o.z * f.z), row + k);
    }
  for (; i < rows.end[MIRRORED_TWOS]; i += 2, row += 2)
    EACH (k, 2) {
      const real4 f = rows.farther[i + k];
      first[2 + k] =
          reached_of_two(first[2 + k], fma(d.y, splat(f.y), d.z * f.z),
                         fma(-o.y, splat(f.y), fma(-o.z, splat(f.z), splat(f.w))), d.x * f.x, o.x * f.x, row + k);
    }
  for (; i + ROWS_ABREAST <= rows.end[ONES]; i += ROWS_ABREAST, row += ROWS_ABREAST)
    EACH (k, ROWS_ABREAST) first[k] = reached_of_one(first[k], o, d, rows.farther[i + k], row + k);
  for (; i < rows.end[ONES]; i++, row += 1) first[3] = reached_of_one(first[3], o, d, rows.farther[i], row);
  first[0] = reached(first[0], first[1].speed, first[1].gap, first[1].row);
  first[2] = reached(first[2], first[3].speed, first[3].gap, first[3].row);
  first[0] = reached(first[0], first[2].speed, first[2].gap, first[2].row);

  // The same again for that row alone, exactly.
  const realL number = first[0].row;
  const rowL found = row_at(rows, number);
  vec3L normal = found.normal;
  if (rows.end[MIRRORED_TWOS] > 0) {
    const tierL tier = tier_of(o, d, normal.y, found.offset);
    signsL signs = signs_of_four(tier, c, normal.x, normal.z);
    const maskL four = number < rows.end[FOURS], turned = number < rows.end[TURNED_TWOS];
    const realL along_x = normal.x * d.x, along_z = normal.z * d.z, at_x = normal.x * o.x, at_z = normal.z * o.z;
    const realL of_two = blend(turned, sign_of_two(tier.y, tier.v, along_x + along_z, at_x + at_z),
                               sign_of_two(tier.y + along_z, tier.v - at_z, along_x, at_x));
    const realL of_pair = blend(number < rows.end[MIRRORED_TWOS], of_two, splat(1));
    signs.x = blend(four, signs.x, of_pair);
    signs.z = blend(four, signs.z, blend(turned, of_pair, splat(1)));
    normal.x = flip(normal.x, signs.x);
    normal.z = flip(normal.z, signs.z);
  }
  const realL speed = dot3(normal, d), gap = fmax(found.offset - dot3(normal, o), splat(SMALLEST_GAP));
  const crossingL crossing = {first[0].speed > 0, gap / fmax(speed, splat(PARALLEL)), normal};
  return crossing;
}

#endif
