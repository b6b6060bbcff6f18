// The stones, whatever their geometry: which of them light from outside enters first and where, where light inside one meets
// its surface, and what they shade.
//
// Where stones overlap, the one that light entered first keeps it until it leaves that stone. If it then is within another,
// it enters that one there.
#ifndef CULET_STONES
#define CULET_STONES
#include "stone_columns.cl"

#define NOBODY (-1) // in place of a stone's number

// Where a ray from outside first meets a stone. Of MANY all is in the axes of light inside that stone.
typedef struct {
  maskL hit;
  realL t;      // R
  vec3L point;  // in the measure of the stone
#if STONES == MANY
  vec3L way;    // its direction
#endif
  vec3L normal; // outward
  intL stone;   // its number
} meetingL;

// R of a stone's own radius by which a ray may start inside it, or end there again, and count as one that passes it by.
#define TOUCH ((real)2e-6)
// Radii of a sphere that surely holds a stone.
#define SPHERE ((real)1.0001)
// R of a stone's own radius by which a ray may start inside a stone of triangles and still enter it there.
#define DEPTH ((real)1e-4)
// Lanes up to which the rays of a packet are quicker one by one: a packet takes some four approaches (rows_entry), each of some 100
// instructions for a brilliant; one ray a third of all that.
#define FEW_LANES (LANES == 16 ? 3 : LANES == 8 ? 3 : LANES == 4 ? 2 : 1)

#if STONES == MANY
// Positions in a stone's measure.
static inline vec3L to_own(world_t world, int number, vec3L point) {
  __constant const stone_t *stone = world.stones + number;
  return scale3(splat(stone->inverse_radius),
                vec3(point.x - stone->centre[0], point.y - stone->centre[1], point.z - stone->centre[2]));
}
#else
static inline vec3L to_own(world_t world, int number, vec3L point) { return point; }
#endif

// Whether a stone is met by its half-spaces, or else by its triangles.
static inline int by_half_spaces(__constant const stone_t *stone) {
  return GEOMETRY == HULL ? 1 : STONES == MANY ? !stone->by_triangles : 0;
}

// How a ray passes a sphere: the middle of its way, from the centre of the sphere, and how far along the ray that is.
typedef struct {
  maskL passes;
  realL middle;
  vec3L foot;
} passageL;

static inline passageL passage(vec3L origin, vec3L direction, realL t_min, real x, real y, real z, real reach) {
  const vec3L apart = vec3(origin.x - x, origin.y - y, origin.z - z);
  passageL passage;
  passage.middle = -dot3(apart, direction);
  passage.foot = along(apart, passage.middle, direction);
  passage.passes = (dot3(passage.foot, passage.foot) < reach * reach) & (passage.middle > t_min - reach);
  return passage;
}

// Whether a ray can meet a stone at all: whether it passes the sphere around one, not wholly before t_min.
static inline maskL passes_stones(world_t world, vec3L origin, vec3L direction, realL t_min) {
#if STONES == MANY
  maskL passes = t_min < t_min;
  for (int i = 0; i < world.scene->groups; i++) {
    __constant const group_t *group = world.groups + i;
    passes |=
        passage(origin, direction, t_min, group->centre[0], group->centre[1], group->centre[2], group->reach).passes;
  }
  return passes;
#else
  const realL middle = -dot3(origin, direction);
  const vec3L nearest = along(origin, middle, direction);
  return (dot3(nearest, nearest) < (real)1.0001) & (middle > t_min - (real)1.0001);
#endif
}

#if STONES == MANY
#if TREE_WIDTH == 16
#define LOWER lo
#define UPPER hi
#else
#define LOWER s01234567
#define UPPER s01234567
#endif
// The extreme of a row of numbers.
#define EXTREME(name, of_two)                                                                                          \
  static inline real name(realW row) {                                                                                 \
    const JOIN(REAL, 8) eight = TREE_WIDTH == 16 ? of_two(row.LOWER, row.UPPER) : row.LOWER;                           \
    const real4 four = of_two(eight.lo, eight.hi);                                                                     \
    const JOIN(REAL, 2) two = of_two(four.lo, four.hi);                                                                \
    return of_two(two.x, two.y);                                                                                       \
  }
EXTREME(largest, fmax)
EXTREME(smallest, fmin)

// Where one ray enters a convex stone, as hull_entry_from has it; its facets are looked at TREE_WIDTH abreast. Returns whether
// it does.
static inline int enters_alone(__global const real *blocks, int count, const real origin[3], const real direction[3],
                               real t_min, real *t, real normal[3]) {
  realW latest = (realW)(-1e30f), soonest = (realW)(1e30f), place = (realW)(0);
  for (int i = 0; i < count; i++) {
    const realW nx = load_wide(blocks, 4 * i), ny = load_wide(blocks, 4 * i + 1), nz = load_wide(blocks, 4 * i + 2);
    const realW speed = fma(nx, (realW)(direction[0]), fma(ny, (realW)(direction[1]), nz * direction[2]));
    const realW gap =
        load_wide(blocks, 4 * i + 3) - fma(nx, (realW)(origin[0]), fma(ny, (realW)(origin[1]), nz * origin[2]));
    const maskW entering = speed <= 0;
    const realW crossing = gap / select(fmax(speed, (realW)(PARALLEL)), fmin(speed, (realW)(-PARALLEL)), entering);
    const maskW later = entering & (crossing > latest);
    latest = select(latest, crossing, later);
    place = select(place, (realW)((real)i), later);
    soonest = select(fmin(soonest, crossing), soonest, entering);
  }
  const real t_in = largest(latest), t_out = smallest(soonest);
  *t = fmax(t_in, t_min);
  if (!(t_in < t_out && t_out - *t > (t_in < t_min ? TOUCH : 0))) return 0;
  const int column = lowest_bit(mask_bits(latest == (realW)(t_in)));
  real places[TREE_WIDTH];
  JOIN(vstore, TREE_WIDTH)(place, 0, places);
  __global const real *facet = blocks + (int)places[column] * 4 * TREE_WIDTH + column;
  EACH (k, 3) normal[k] = facet[k * TREE_WIDTH];
  return 1;
}

// The same for the rays of a packet, one after the other: quicker where few of them are near the stone.
static inline crossingL enter_one_by_one(__global const real *blocks, int count, vec3L origin, vec3L direction,
                                         realL t_min, maskL mask) {
  int wanted[LANES];
  real rows[7][LANES], t[LANES], normal[3][LANES], hit[LANES];
  store_mask(mask, wanted);
  store3(origin, rows);
  store3(direction, rows + 3);
  store_lanes(t_min, rows[6]);
  for (int lane = 0; lane < LANES; lane++) {
    hit[lane] = t[lane] = 0;
    EACH (k, 3) normal[k][lane] = 0;
    if (!wanted[lane]) continue;
    const real from[3] = {rows[0][lane], rows[1][lane], rows[2][lane]},
               towards[3] = {rows[3][lane], rows[4][lane], rows[5][lane]};
    real facet[3] = {0, 0, 0};
    hit[lane] = enters_alone(blocks, count, from, towards, rows[6][lane], t + lane, facet);
    EACH (k, 3) normal[k][lane] = facet[k];
  }
  const crossingL crossing = {load_lanes(hit) > 0, load_lanes(t), load3(normal)};
  return crossing;
}

// Where rays enter a stone, all in its measure and the axes of light inside; their facets are those of any stone of its shape. It is part
// of its callers, as meet_next is: by themselves they would get their packets by way of memory.
__attribute__((always_inline)) static inline crossingL
enter_shape(world_t world, __constant const stone_t *stone, vec3L origin, vec3L direction, realL t_min, maskL mask) {
  if (packing_of(mask).count <= FEW_LANES)
    return enter_one_by_one(world.blocks + stone->first_block * 4 * TREE_WIDTH, stone->blocks, origin, direction, t_min,
                            mask);
  const realL begin = fmax(t_min, splat(-SPHERE)); // rays go on from their feet, so none is in the sphere before
  maskL within;
  crossingL crossing =
      rows_entry(rows_of(world.rows + stone->first_row, stone->row_end), origin, direction, begin, mask, &within);
  if (any_lane(within)) {
    const crossingL from =
        hull_entry_from(world.facets + stone->first_facet, stone->facets, origin, direction, t_min, TOUCH);
    crossing.hit |= within & from.hit;
    crossing.t = blend(within, from.t, crossing.t);
    crossing.normal = blend3(within, from.normal, crossing.normal);
  }
  return crossing;
}

// Takes up where rays cross stones, if that comes before what they met so far. Those go on from a foot along a way, which their own
// measure is `radius` R of, `middle` R after they begin.
static inline void meet(meetingL *first, maskL mask, crossingL crossing, realL middle, realL radius, vec3L foot,
                        vec3L way, intL number) {
  const realL t = fma(crossing.t, radius, middle);
  const maskL sooner = mask & crossing.hit & (t < first->t);
  first->hit |= sooner;
  first->t = blend(sooner, t, first->t);
  first->point = blend3(sooner, along(foot, crossing.t, way), first->point);
  first->way = blend3(sooner, way, first->way);
  first->normal = blend3(sooner, crossing.normal, first->normal);
  first->stone = blend_ints_by(sooner, number, first->stone);
}

// Looks whether rays enter this stone before the one that they met so far. `from` is the stone that each comes from.
static inline void meet_stone(world_t world, int number, vec3L origin, vec3L direction, realL t_min, maskL mask,
                              intL from, meetingL *first) {
  __constant const stone_t *stone = world.stones + number;
  const passageL past =
      passage(origin, direction, t_min, stone->centre[0], stone->centre[1], stone->centre[2], stone->reach);
  const maskL returns = widen(from == (intL)(number));
  maskL near = mask & past.passes & (past.middle - stone->reach < first->t);
  if (stone->convex) near &= !returns;
  if (!any_lane(near)) return;
  const vec3L foot = into_axes(stone->inner_axes, scale3(splat(stone->inverse_radius), past.foot)),
              way = into_axes(stone->inner_axes, direction);
  const realL start = (t_min - past.middle) * stone->inverse_radius;
  crossingL crossing;
  if (by_half_spaces(stone))
    crossing = enter_shape(world, stone, foot, way, start, near);
  else {
    crossing =
        mesh_crossing(stone, tree_of(world), foot, way, blend(returns, start, start - DEPTH), (real)1e30, near, 1);
    crossing.t = fmax(crossing.t, start);
  }
  meet(first, near, crossing, past.middle, splat(stone->radius), foot, way, (intL)(number));
}

static inline meetingL nobody(vec3L origin, vec3L direction) {
  const maskL none = origin.x < origin.x;
  const meetingL meeting = {none, splat(1e30f), origin, direction, direction, (intL)(NOBODY)};
  return meeting;
}
#endif

#if STONES == MANY
// The stones that each ray may meet, a bit each.
#define NEAR_WORDS (MAX_STONES / 32)
typedef struct {
  intL word[NEAR_WORDS];
} nearL;

static inline maskL any_near(const nearL *near) {
  intL all = near->word[0];
  for (int k = 1; k < NEAR_WORDS; k++) all |= near->word[k];
  return widen(all != 0);
}

// Steps of a number next to 1, in single precision, by which spheres count as larger, as parts of squared distances: twice what rounding
// does to their differences, some 16 steps at most.
#define NEAR_STEPS 32
#define NEAR_SLACK ((real)(NEAR_STEPS * FLT_EPSILON))

// The stones whose spheres rays pass after t_min, coming from this one or from NOBODY. Of a ray that begins at s from the middle of a
// group, and a sphere at c from there, q = |s - c|^2 - reach^2 is negative within the sphere; else the ray passes it where it has a
// way m = (c - s) d > 0 to the point abreast of it, and q < m^2. A stone takes seven multiply-adds of that: |s|^2 and s d are of its
// whole group, |c|^2 - reach^2 is known beforehand.
static inline nearL near_stones(world_t world, vec3L origin, vec3L direction, realL t_min, intL from) {
  nearL near;
  EACH (k, NEAR_WORDS) near.word[k] = (intL)(0);
  for (int i = 0; i < world.scene->groups; i++) {
    __constant const group_t *group = world.groups + i;
    const vec3L start = along(
        vec3(origin.x - group->centre[0], origin.y - group->centre[1], origin.z - group->centre[2]), t_min, direction);
    const realL way = dot3(start, direction), squared = ((real)1 - NEAR_SLACK) * dot3(start, start);
    const realL ahead_of_all = fmax(-way, splat(0));
    if (!any_lane(fma(-ahead_of_all, ahead_of_all, squared) < group->reach * group->reach)) continue;
    const vec3L twice = scale3(splat(-2), start);
    intL bits = (intL)(0);
    for (int number = group->first; number < group->last; number++) {
      __constant const stone_t *stone = world.stones + number;
      const realL x = splat(stone->apart[0]), y = splat(stone->apart[1]), z = splat(stone->apart[2]);
      const realL outside = fma(x, twice.x, fma(y, twice.y, fma(z, twice.z, squared))) + stone->power;
      const realL ahead = fmax(fma(x, direction.x, fma(y, direction.y, fma(z, direction.z, -way))), splat(0));
      maskL passes = fma(-ahead, ahead, outside) < 0;
      if (GEOMETRY == MESH && stone->convex) passes &= !widen(from == (intL)(number));
      bits |= blend_ints_by(passes, (intL)(1 << number % 32), (intL)(0));
    }
    EACH (k, NEAR_WORDS)
      if (group->first / 32 == k) near.word[k] |= bits;
  }
  if (GEOMETRY == HULL)
    EACH (k, NEAR_WORDS) near.word[k] &= ~blend_ints(from >> 5 == (intL)(k), (intL)(1) << (from & 31), (intL)(0));
  return near;
}

// How far along a ray the sphere around a stone begins, each lane of its own; rounded down, however far away that is.
static inline realL sphere_begins(world_t world, intL number, vec3L origin, vec3L direction) {
  const vec3L centre = vector_by_stone(world, COLUMN_CENTRE, number);
  const realL reach = SPHERE * by_stone(world, COLUMN_RADIUS, number);
  const vec3L apart = vec3(origin.x - centre.x, origin.y - centre.y, origin.z - centre.z);
  const realL middle = -dot3(apart, direction), squared = NEAR_SLACK * dot3(apart, apart);
  const vec3L foot = along(apart, middle, direction);
  return middle - sqrt(fmax(fma(reach, reach, squared - dot3(foot, foot)), splat(0)));
}

// Takes one of them for each ray; NOBODY where there is none.
static inline intL take_near(nearL *near) {
  intL number = (intL)(NOBODY), none_yet = (intL)(-1);
  EACH (k, NEAR_WORDS) {
    const intL word = near->word[k];
    const intL here = none_yet & (intL)(blend_ints(word != 0, (intL)(-1), (intL)(0)));
    number = blend_ints(here != 0, bit_number(word & -word) + (intL)(32 * k), number);
    near->word[k] = blend_ints(here != 0, word & (word - 1), word);
    none_yet &= ~here;
  }
  return number;
}

// Takes the one of them whose sphere each ray enters first; those of the others begin `then` R along the ray at the soonest.
static inline intL take_nearest(world_t world, nearL *near, vec3L origin, vec3L direction, realL *then) {
  nearL left = *near;
  intL nearest = take_near(&left);
  *then = splat(1e30f);
  if (!any_lane(any_near(&left))) {
    *near = left;
    return nearest;
  }
  realL first = sphere_begins(world, nearest, origin, direction);
  while (any_lane(any_near(&left))) {
    const intL number = take_near(&left);
    const maskL there = widen(number >= 0);
    const realL begins = blend(there, sphere_begins(world, number, origin, direction), splat(1e30f));
    const maskL sooner = begins < first;
    *then = fmin(*then, blend(sooner, first, begins));
    first = blend(sooner, begins, first);
    nearest = blend_ints_by(sooner, number, nearest);
  }
  EACH (k, NEAR_WORDS) near->word[k] &= ~blend_ints(nearest >> 5 == (intL)(k), (intL)(1) << (nearest & 31), (intL)(0));
  return nearest;
}

// Looks whether rays enter this stone before the one that they met so far, each ray another one of the same shape. `stone` is any
// of them.
static inline void meet_alike(world_t world, __constant const stone_t *stone, intL number, vec3L origin,
                              vec3L direction, realL t_min, maskL mask, meetingL *first) {
  const axesL axes = inner_axes_of(world, number);
  const realL inverse = by_stone(world, COLUMN_INVERSE_RADIUS, number), radius = by_stone(world, COLUMN_RADIUS, number);
  const vec3L centre = vector_by_stone(world, COLUMN_CENTRE, number);
  const vec3L apart = vec3(origin.x - centre.x, origin.y - centre.y, origin.z - centre.z);
  const realL middle = -dot3(apart, direction);
  mask &= middle - SPHERE * radius < first->t;
  if (!any_lane(mask)) return;
  const vec3L foot = into_axes_of(axes, scale3(inverse, along(apart, middle, direction))),
              way = into_axes_of(axes, direction);
  const crossingL crossing = enter_shape(world, stone, foot, way, (t_min - middle) * inverse, mask);
  meet(first, mask, crossing, middle, radius, foot, way, number);
}

// The same for rays of stones of any shape.
static inline void meet_each(world_t world, intL number, vec3L origin, vec3L direction, realL t_min, maskL mask,
                             intL from, meetingL *first) {
  if (ALIKE) {
    meet_alike(world, world.stones, number, origin, direction, t_min, mask, first);
    return;
  }
  const realL alike = by_stone(world, COLUMN_ALIKE, number);
  while (any_lane(mask)) {
    const int kind = first_number(mask, reals_to_int(alike));
    const maskL same = mask & (alike == splat((real)kind));
    __constant const stone_t *stone = world.stones + kind;
    if (by_half_spaces(stone))
      meet_alike(world, stone, number, origin, direction, t_min, same, first);
    else
      meet_stone(world, kind, origin, direction, t_min, same, from, first);
    mask &= !same;
  }
}
#endif

#if STONES == MANY
// Looks whether each of these rays enters one of the stones that it is near, before the one that it met so far: that one whose sphere
// begins first. No stone is left to be asked where all that are left begin beyond.
__attribute__((always_inline)) static inline void meet_next(world_t world, nearL *near, vec3L origin, vec3L direction,
                                                            realL t_min, maskL mask, intL from, meetingL *first) {
  realL then;
  const intL number = take_nearest(world, near, origin, direction, &then);
  meet_each(world, blend_ints(number < 0, (intL)(0), number), origin, direction, t_min, mask & widen(number >= 0), from,
            first);
  EACH (k, NEAR_WORDS) near->word[k] = blend_ints_by(first->t < then, (intL)(0), near->word[k]);
}
#endif

// The stone that a ray from outside enters first. `from` is the stone that it comes from, or NOBODY.
static inline meetingL stone_entry(world_t world, vec3L origin, vec3L direction, realL t_min, maskL mask, intL from) {
#if STONES == MANY
  meetingL first = nobody(origin, direction);
  nearL near = near_stones(world, origin, direction, t_min, from);
  for (;;) {
    const maskL asking = mask & any_near(&near);
    if (!any_lane(asking)) return first;
    meet_next(world, &near, origin, direction, t_min, asking, from, &first);
  }
#else
  const crossingL crossing =
      GEOMETRY == HULL ? hull_entry(world.facets, world.stones->facets, origin, direction, t_min)
                       : mesh_crossing(world.stones, tree_of(world), origin, direction, t_min, (real)1e30, mask, 1);
  const meetingL meeting = {crossing.hit, crossing.t, along(origin, crossing.t, direction), crossing.normal, (intL)(0)};
  return meeting;
#endif
}

// Where light inside a stone meets its surface, in the stone's own measure.
static inline crossingL stone_exit(world_t world, __constant const stone_t *stone, vec3L origin, vec3L direction,
                                   maskL mask) {
  if (by_half_spaces(stone))
    return hull_exit(world.facets + (STONES == MANY ? stone->first_facet : 0), stone->facets, origin, direction);
  return mesh_crossing(stone, tree_of(world), origin, direction, splat(0), (real)1e30, mask, -1);
}

// The same in the axes of light inside.
__attribute__((always_inline)) static inline crossingL inner_exit(world_t world, __constant const stone_t *stone,
                                                                  vec3L origin, vec3L direction, maskL mask) {
  if (by_half_spaces(stone))
    return rows_exit(rows_of(world.rows + (STONES == MANY ? stone->first_row : 0), stone->row_end), origin, direction);
  return mesh_crossing(stone, tree_of(world), origin, direction, splat(0), (real)1e30, mask, -1);
}

// Directions, and places about a stone's centre, in the axes of light inside, and back.
static inline vec3L inward(__constant const stone_t *stone, vec3L v) {
  return INNER_AXES ? into_axes(stone->inner_axes, v) : v;
}
static inline vec3L outward(__constant const stone_t *stone, vec3L v) {
  return INNER_AXES ? out_of_axes(stone->inner_axes, v) : v;
}

// A ray that begins inside a stone, at a point of the frame.
static inline meetingL from_inside(world_t world, int number, vec3L point, vec3L direction) {
  meetingL met;
  met.hit = point.x >= point.x;
  met.t = splat(0);
  met.point = to_own(world, number, point);
  met.normal = direction;
  met.stone = (intL)(number);
#if STONES == MANY
  met.point = inward(world.stones + number, met.point);
  met.way = inward(world.stones + number, direction);
#endif
  return met;
}

// What leaves a stone: of MANY it is turned out of those axes later, in a full packet.
static inline vec3L turned_out(__constant const stone_t *stone, vec3L v) {
  return STONES == MANY ? v : outward(stone, v);
}

// Whether a stone lies between points of the room and a light; all in the stone's own measure.
static inline maskL shaded_by(world_t world, __constant const stone_t *stone, int light, vec3L point, vec3L to_light,
                              real reach, maskL mask) {
  // The line to the light passes the sphere if its moment about the centre is less than its length.
  const vec3L moment = cross3(point, to_light);
  const maskL near = mask & (dot3(moment, moment) < reach * dot3(to_light, to_light));
  if (!any_lane(near)) return near;
  if (by_half_spaces(stone))
    return near & hull_shadow(world.shadows, stone->shadow_start[light], stone->shadow_start[light + 1], point);
  return mesh_crossing(stone, tree_of(world), point, to_light, splat(0), 1, near, 1).hit;
}

// Whether stones lie between points of the room and a light.
static inline maskL stone_shadow(world_t world, int light, vec3L point, vec3L to_light, maskL mask) {
  maskL shaded = mask & !mask;
  if (GEOMETRY == EMPTY) return shaded;
  if (STONES == ONE) return shaded_by(world, world.stones, light, point, to_light, (real)1.0001, mask);
  const realL squared = dot3(to_light, to_light);
  for (int i = 0; i < world.scene->groups; i++) {
    __constant const group_t *group = world.groups + i;
    const vec3L moment =
        cross3(vec3(point.x - group->centre[0], point.y - group->centre[1], point.z - group->centre[2]), to_light);
    const maskL near = mask & !shaded & (dot3(moment, moment) < group->reach * group->reach * squared);
    if (!any_lane(near)) continue;
    for (int number = group->first; number < group->last; number++) {
      __constant const stone_t *stone = world.stones + number;
      const real reach = stone->reach * stone->inverse_radius;
      shaded |= shaded_by(world, stone, light, to_own(world, number, point),
                          scale3(splat(stone->inverse_radius), to_light), reach * reach, near & !shaded);
    }
  }
  return shaded;
}

#endif
