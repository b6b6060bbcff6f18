// Where light inside a convex stone leaves, by the symmetry of its facets.
//
// Light inside is followed in axes of the stone in which most facets are images of each other: eight are (+-x, y, +-z) and
// (+-z, y, +-x), four are (+-x, y, +-z), two are (x, y, z) and (-x, y, -z), or (+-x, y, z). Of two of them, signs tell which a
// ray reaches first, and so of all. A row stands for eight facets, for four, two or one (rendering/stones/facet_rows.py).
#ifndef CULET_FACET_ROWS
#define CULET_FACET_ROWS
#include "hull.cl"

// Kinds of row, in their order: of eight facets, where z may be 0; of four; of two by a half turn about y; of two by a mirror
// across x; of one. In the first two x and z are not negative, and x is not the smaller in the first. Rows of two facets are
// even in number.
#define EIGHTS 0
#define FOURS 1
#define TURNED_TWOS 2
#define MIRRORED_TWOS 3
#define ONES 4
#define COLUMN_ROWS 32 // rows up to which a stone's are in columns too

// Steps of a number next to 1, R, by which offsets are too large where a ray looks for its facet: so the gap to the facet that it
// has just left is positive, however it was rounded.
#define HAIR 3
#if IS_DOUBLE
#define HAIR_LENGTH (HAIR * DBL_EPSILON)
#else
#define HAIR_LENGTH (HAIR * FLT_EPSILON)
#endif

typedef struct {
  __global const real4 *farther; // normals and offsets: the latter are a HAIR too large,
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

// Of facets of normals (s x, y, t z), where s and t are signs, at a ray o + l d: the speed is Y + s x d.x + t z d.z and the gap
// is V - s x o.x - t z o.z, where Y = y d.y and V = offset - y o.y. With
//   A = d.x V + o.x Y, B = d.z V + o.z Y, C = d.x o.z - d.z o.x
// of two that differ in s the one with s = 1 is reached first where A - t z C is positive; of two that differ in t the one with
// t = 1 where B + s x C is; and (s z, y, t x) before (s x, y, t z), if x > z, where t B - s A + s t (x + z) C is.
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

// The signs s and t of the facet of four that is reached first: of A - t z C and of B + s x C, each of which names the other.
// But where the sign of B differs from t, |B| < x |C|, t is that of s C, and s is the sign of A - s z |C|, which then is that of
// A - sign(B) z C too, since s C and B differ in sign; and likewise for A. Of eight, the facets beside an axis have the same x,
// or that for their z: the larger takes the place of both.
static inline signsL first_signs(tierL tier, realL c, realL normal_x, realL normal_z) {
  const signsL signs = {fma(-flip(c, tier.b), normal_z, tier.a), fma(flip(c, tier.a), normal_x, tier.b)};
  return signs;
}

// Whether of eight facets one with x and z exchanged is the first.
static inline maskL exchanged(tierL tier, realL c, signsL signs, realL sum) {
  return fma(flip(flip(c, signs.x), signs.z), sum, flip(tier.b, signs.z) - flip(tier.a, signs.x)) > 0;
}

static inline reachL reached_of_tier(reachL first, vec3L o, vec3L d, tierL tier, realL x, realL z, realL row) {
  return reached(first, fma(d.x, x, fma(d.z, z, tier.y)), fma(-o.x, x, fma(-o.z, z, tier.v)), row);
}

static inline reachL reached_of_four(reachL first, vec3L o, vec3L d, realL c, real4 facet, realL row) {
  const tierL tier = tier_of(o, d, splat(facet.y), splat(facet.w));
  const signsL signs = first_signs(tier, c, splat(facet.x), splat(facet.z));
  return reached_of_tier(first, o, d, tier, flip(splat(facet.x), signs.x), flip(splat(facet.z), signs.z), row);
}

static inline reachL reached_of_eight(reachL first, vec3L o, vec3L d, realL c, real4 facet, realL row) {
  const tierL tier = tier_of(o, d, splat(facet.y), splat(facet.w));
  const signsL signs = first_signs(tier, c, splat(facet.x), splat(facet.x));
  const maskL other = exchanged(tier, c, signs, splat(facet.x + facet.z));
  const realL x = blend(other, splat(facet.z), splat(facet.x)), z = blend(other, splat(facet.x), splat(facet.z));
  return reached_of_tier(first, o, d, tier, flip(x, signs.x), flip(z, signs.z), row);
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
  for (; i < rows.end[EIGHTS]; i++, row += 1) first[0] = reached_of_eight(first[0], o, d, c, rows.farther[i], row);
  for (; i < rows.end[FOURS]; i++, row += 1) first[1] = reached_of_four(first[1], o, d, c, rows.farther[i], row);
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

  // The facet again, as it was found; then exactly where it is.
  const realL number = first[0].row;
  const rowL found = row_at(rows, number);
  vec3L normal = found.normal;
  if (rows.end[MIRRORED_TWOS] > 0) {
    const tierL tier = tier_of(o, d, normal.y, found.offset + HAIR_LENGTH);
    signsL signs = {splat(1), splat(1)};
    if (rows.end[MIRRORED_TWOS] > rows.end[FOURS]) {
      const maskL turned = number < rows.end[TURNED_TWOS];
      const realL along_x = normal.x * d.x, along_z = normal.z * d.z, at_x = normal.x * o.x, at_z = normal.z * o.z;
      const realL of_two = blend(turned, sign_of_two(tier.y, tier.v, along_x + along_z, at_x + at_z),
                                 sign_of_two(tier.y + along_z, tier.v - at_z, along_x, at_x));
      signs.x = blend(number < rows.end[MIRRORED_TWOS], of_two, signs.x);
      signs.z = blend(turned, of_two, signs.z);
    }
    if (rows.end[FOURS] > 0) {
      const maskL four = number < rows.end[FOURS], eight = number < rows.end[EIGHTS];
      const signsL of_four = first_signs(tier, c, normal.x, blend(eight, normal.x, normal.z));
      signs.x = blend(four, of_four.x, signs.x);
      signs.z = blend(four, of_four.z, signs.z);
      const maskL other = eight & exchanged(tier, c, signs, normal.x + normal.z);
      normal = vec3(blend(other, normal.z, normal.x), normal.y, blend(other, normal.x, normal.z));
    }
    normal.x = flip(normal.x, signs.x);
    normal.z = flip(normal.z, signs.z);
  }
  const realL speed = dot3(normal, d), gap = fmax(found.offset - dot3(normal, o), splat(SMALLEST_GAP));
  const crossingL crossing = {(first[0].speed > 0) & (speed > 0), gap / fmax(speed, splat(PARALLEL)), normal};
  return crossing;
}

// Of the facets whose planes a point is outside of, the one that it is farthest outside: by `excess` R; the number of its row.
typedef struct {
  realL excess, row;
} farthestL;

static inline farthestL farther_out(farthestL first, realL excess, realL row) {
  const farthestL now = {fmax(excess, first.excess), blend(excess > first.excess, row, first.row)};
  return now;
}

static inline farthestL farthest_facet(rows_t rows, vec3L p) {
  const realL beside_x = fabs(p.x), beside_z = fabs(p.z);
  const realL wide = fmax(beside_x, beside_z), narrow = fmin(beside_x, beside_z);
  farthestL first = {splat(-1e30f), splat(0)};
  realL row = splat(0);
  int i = 0;
  for (; i < rows.end[EIGHTS]; i++, row += 1) {
    const real4 f = rows.exact[i];
    first = farther_out(first, fma(p.y, splat(f.y), fma(wide, splat(f.x), fma(narrow, splat(f.z), splat(-f.w)))), row);
  }
  for (; i < rows.end[FOURS]; i++, row += 1) {
    const real4 f = rows.exact[i];
    first = farther_out(first, fma(p.y, splat(f.y), fma(beside_x, splat(f.x), fma(beside_z, splat(f.z), splat(-f.w)))),
                        row);
  }
  for (; i < rows.end[TURNED_TWOS]; i++, row += 1) {
    const real4 f = rows.exact[i];
    first = farther_out(first, fabs(fma(p.x, splat(f.x), p.z * f.z)) + fma(p.y, splat(f.y), splat(-f.w)), row);
  }
  for (; i < rows.end[MIRRORED_TWOS]; i++, row += 1) {
    const real4 f = rows.exact[i];
    first = farther_out(first, fabs(p.x * f.x) + fma(p.y, splat(f.y), fma(p.z, splat(f.z), splat(-f.w))), row);
  }
  for (; i < rows.end[ONES]; i++, row += 1) {
    const real4 f = rows.exact[i];
    first = farther_out(first, fma(p.x, splat(f.x), fma(p.y, splat(f.y), fma(p.z, splat(f.z), splat(-f.w)))), row);
  }
  return first;
}

// The facet of a row that a point is farthest outside.
static inline rowL facet_at(rows_t rows, realL number, vec3L p) {
  rowL facet = row_at(rows, number);
  if (rows.end[MIRRORED_TWOS] == 0) return facet;
  const maskL eight = number < rows.end[EIGHTS], four = number < rows.end[FOURS],
              turned = number < rows.end[TURNED_TWOS], single = number >= rows.end[MIRRORED_TWOS];
  const maskL other = eight & (fabs(p.z) > fabs(p.x));
  vec3L normal =
      vec3(blend(other, facet.normal.z, facet.normal.x), facet.normal.y, blend(other, facet.normal.x, facet.normal.z));
  const realL at_x = p.x * normal.x, at_z = p.z * normal.z, of_two = blend(turned, at_x + at_z, at_x);
  normal.x = flip(normal.x, blend(single, splat(1), blend(four, p.x, of_two)));
  normal.z = flip(normal.z, blend(four, p.z, blend(turned, of_two, splat(1))));
  facet.normal = normal;
  return facet;
}

#define MOST_APPROACHES 64

// Where rays enter a stone that they may meet after `t`. How far a ray is outside the facet that it is farthest outside is a convex
// function of the way along it, in straight pieces. So Newton's method, which goes on to where that facet's plane is crossed, never
// passes the first zero from the left, where the ray enters; and where the ray nears that facet's plane no more, it misses the stone.
// Of a brilliant's packets the last lane takes four steps. Lanes that begin `within` the stone, or that are not done after
// MOST_APPROACHES, are not told.
static inline crossingL rows_entry(rows_t rows, vec3L o, vec3L d, realL t, maskL mask, maskL *within) {
  const maskL none = mask & !mask;
  crossingL crossing = {none, t, d};
  maskL going = mask;
  *within = none;
  for (int i = 0; i < MOST_APPROACHES; i++) {
    const vec3L p = along(o, crossing.t, d);
    const farthestL farthest = farthest_facet(rows, p);
    const maskL outside = farthest.excess > 0, arrives = going & !outside;
    if (i == 0)
      *within = arrives;
    else
      crossing.hit |= arrives;
    going &= outside;
    if (!any_lane(going)) return crossing;
    const rowL facet = facet_at(rows, farthest.row, p);
    const realL speed = dot3(facet.normal, d);
    going &= speed < 0;
    const realL next = (facet.offset - dot3(facet.normal, o)) / fmin(speed, splat(-PARALLEL));
    const maskL later = next > crossing.t; // by rounding a plane may have been crossed already
    crossing.t = blend(going & later, next, crossing.t);
    crossing.normal = blend3(going, facet.normal, crossing.normal);
    crossing.hit |= going & !later;
    going &= later;
    if (!any_lane(going)) return crossing;
  }
  *within |= going;
  return crossing;
}

#endif
