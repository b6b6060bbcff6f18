/* The points at which two stones touch. */
#include "solver.h"

#include <string.h>

#define FACE_POINT ((uint64_t)1 << 62)
#define LOWEST_POINT ((uint64_t)2 << 62)
#define EDGE_POINT ((uint64_t)3 << 62)
#define CUT ((uint32_t)1 << 31)   /* a corner that clipping has made, not one of the polygon's own */
#define PLANE ((uint32_t)1 << 11) /* a side likewise */
#define FAVOUR 0.5                /* SLOP: by less an axis is not preferred to a face; what touches overlaps by SLOP */
#define ALONG 0.9998              /* cosine: a face so nearly across the axis of two edges may touch as well */

/* Pose of the second in the first one's axes. */
void pair_pose(const Body *first, const Body *second, Mat3 *turn, Vec3 *offset) {
  const Mat3 *a = &first->axes, *b = &second->axes;
  Vec3 x = vec(a->a.x, a->b.x, a->c.x), y = vec(a->a.y, a->b.y, a->c.y), z = vec(a->a.z, a->b.z, a->c.z);
  *turn = (Mat3){transposed_times(b, x), transposed_times(b, y), transposed_times(b, z)};
  *offset = transposed_times(a, sub(second->position, first->position));
}

static int most_opposed_face(const Hull *hull, Vec3 normal) {
  int found = 0;
  double least = INFINITY;
  for (int i = 0; i < hull->face_count; i++) {
    double along = dot(hull->normal[i], normal);
    if (along < least) {
      least = along;
      found = i;
    }
  }
  return found;
}

/* The other's face that is most opposed to this one, clipped by the planes through this one's edges (Sutherland and
 * Hodgman 1974): its corners nearer to the face than `margin`, half way between the two. */
static int clipped_face(const Hull *hull, int face, const Hull *other, const Mat3 *turn, Vec3 offset, double margin,
                        int swapped, PairRoom *room, PairPoint *points) {
  Vec3 normal = hull->normal[face];
  int incident = most_opposed_face(other, transposed_times(turn, normal));
  Vec3 *polygon = room->polygon, *clipped = room->clipped;
  uint32_t *names = room->names, *clipped_names = room->clipped_names;
  uint32_t *sides = room->sides, *clipped_sides = room->clipped_sides;
  int count = 0;
  for (int i = other->first[incident]; i < other->first[incident + 1]; i++) {
    polygon[count] = add(times(turn, hull_vertex(other, other->corners[i])), offset);
    names[count] = (uint32_t)other->corners[i];
    sides[count] = (uint32_t)count;
    count++;
  }
  int begin = hull->first[face], end = hull->first[face + 1];
  for (int i = begin; i < end && count > 0; i++) {
    Vec3 p = hull_vertex(hull, hull->corners[i]);
    Vec3 q = hull_vertex(hull, hull->corners[i + 1 < end ? i + 1 : begin]);
    Vec3 outward = cross(sub(q, p), normal);
    double size = length(outward);
    if (size < 1e-14) continue;
    outward = scaled(outward, 1 / size);
    double limit = dot(outward, p);
    int left = 0;
    for (int k = 0; k < count && left < MAX_CORNERS - 2; k++) {
      int next = k + 1 < count ? k + 1 : 0;
      double here = dot(outward, polygon[k]) - limit, there = dot(outward, polygon[next]) - limit;
      if (here <= 0) {
        clipped[left] = polygon[k];
        clipped_sides[left] = sides[k];
        clipped_names[left++] = names[k];
      }
      if ((here < 0 && there > 0) || (here > 0 && there < 0)) {
        clipped[left] = add(polygon[k], scaled(sub(polygon[next], polygon[k]), here / (here - there)));
        clipped_sides[left] = here < 0 ? PLANE | (uint32_t)(i - begin) : sides[k];
        clipped_names[left++] = CUT | (uint32_t)(i - begin) << 12 | sides[k];
      }
    }
    Vec3 *corners = polygon;
    uint32_t *corner_names = names, *corner_sides = sides;
    polygon = clipped, names = clipped_names, sides = clipped_sides;
    clipped = corners, clipped_names = corner_names, clipped_sides = corner_sides;
    count = left;
  }
  int found = 0;
  uint64_t faces = FACE_POINT | (uint64_t)(swapped ? 1 : 0) << 54 | (uint64_t)face << 43 | (uint64_t)incident << 32;
  for (int k = 0; k < count; k++) {
    double gap = dot(normal, polygon[k]) - hull->offset[face];
    if (gap <= margin) points[found++] = (PairPoint){sub(polygon[k], scaled(normal, gap / 2)), gap, faces | names[k]};
  }
  return found;
}

/* Likewise of the second one's face, in the first one's axes. */
static int clipped_second_face(const Hull *first, const Hull *second, int face, const Mat3 *turn, Vec3 offset,
                               double margin, PairRoom *room, PairPoint *points) {
  Mat3 back = {{turn->a.x, turn->b.x, turn->c.x}, {turn->a.y, turn->b.y, turn->c.y}, {turn->a.z, turn->b.z, turn->c.z}};
  Vec3 away = negated(transposed_times(turn, offset));
  int count = clipped_face(second, face, first, &back, away, margin, 1, room, points);
  for (int i = 0; i < count; i++) points[i].point = add(times(turn, points[i].point), offset);
  return count;
}

/* Half way between the two edges, where they are nearest (Ericson, Real-Time Collision Detection, 5.1.9). */
static PairPoint crossing_edges(const Hull *first, const Hull *second, const Axis *axis, const PairRoom *room) {
  const int32_t *edge = first->edges[axis->first], *other = second->edges[axis->second];
  Vec3 p = hull_vertex(first, edge[0]), u = sub(hull_vertex(first, edge[1]), p);
  Vec3 q = room->vertices[other[0]], w = sub(room->vertices[other[1]], q);
  Vec3 r = sub(p, q);
  double uu = dot(u, u), ww = dot(w, w), uw = dot(u, w), ur = dot(u, r), wr = dot(w, r);
  double determinant = uu * ww - uw * uw;
  double s = determinant > 0 ? smaller(larger((uw * wr - ur * ww) / determinant, 0), 1) : 0;
  double t = smaller(larger((uw * s + wr) / ww, 0), 1);
  Vec3 middle = scaled(add(add(p, scaled(u, s)), add(q, scaled(w, t))), 0.5);
  return (PairPoint){middle, axis->distance, EDGE_POINT | (uint64_t)axis->first << 16 | (uint64_t)axis->second};
}

/* Two edges that cross touch at one point. Where one of their faces is nearly across the axis, the stones nearly lie on
 * each other and turn about that point: the points at which they are to touch next, no deeper than the edges are. */
static int points_beside_edges(const Hull *first, const Hull *second, const Axis *axis, const Mat3 *turn, Vec3 offset,
                               double margin, PairRoom *room, PairPoint *points) {
  double best = ALONG;
  int face = NONE, of_second = 0, count, left = 0;
  for (int i = 2; i < 4; i++) {
    int one = first->edges[axis->first][i], other = second->edges[axis->second][i];
    double along = dot(first->normal[one], axis->normal);
    if (along > best) best = along, face = one, of_second = 0;
    along = -dot(times(turn, second->normal[other]), axis->normal);
    if (along > best) best = along, face = other, of_second = 1;
  }
  if (face == NONE) return 0;
  count = of_second ? clipped_second_face(first, second, face, turn, offset, margin, room, points)
                    : clipped_face(first, face, second, turn, offset, margin, 0, room, points);
  double same = SAME * smaller(first->inradius, second->inradius);
  for (int i = 0; i < count; i++) {
    Vec3 apart = sub(points[i].point, points[-1].point);
    if (dot(apart, apart) < same * same) continue;
    points[left] = points[i];
    points[left++].gap = larger(points[i].gap, axis->distance);
  }
  return left;
}

/* The deepest point, then always the one farthest from those chosen. */
static int chosen_points(PairPoint *points, int count) {
  if (count <= PAIR_POINTS) return count;
  for (int taken = 0; taken < PAIR_POINTS; taken++) {
    int best = taken;
    double farthest = -INFINITY;
    for (int i = taken; i < count; i++) {
      double worth = INFINITY;
      if (taken == 0) worth = -points[i].gap;
      for (int k = 0; k < taken; k++) {
        Vec3 apart = sub(points[i].point, points[k].point);
        worth = smaller(worth, dot(apart, apart));
      }
      if (worth > farthest + (taken == 0 ? 1e-9 : 0)) {
        farthest = worth;
        best = i;
      }
    }
    if (taken > 0 && farthest < 1e-10) return taken;
    PairPoint point = points[taken];
    points[taken] = points[best];
    points[best] = point;
  }
  return PAIR_POINTS;
}

/* Of two stones nearer than `margin`: how many points, which are in the room for a pair, in the world; and the normal
 * from the first to the second. */
int pair_points(World *world, int one, int other, double margin, Vec3 *normal) {
  const Body *a = &world->bodies[one], *b = &world->bodies[other];
  const Hull *first = &a->hull, *second = &b->hull;
  PairRoom *room = world->room;
  PairPoint *points = room->points;
  Mat3 turn;
  Vec3 offset;
  pair_pose(a, b, &turn, &offset);
  double favour = FAVOUR * SLOP * smaller(a->size, b->size);
  Vec3 *lately = &world->separating[one * world->capacity + other];
  if (dot(*lately, *lately) > 0) {
    double reach = -hull_lowest(first, negated(*lately), room->reaches);
    double other_reach = hull_lowest(second, transposed_times(&turn, *lately), room->reaches);
    if (dot(*lately, offset) + other_reach - reach > margin) return 0;
  }
  Axis axis = separation(first, second, &turn, offset, margin, favour, room);
  *lately = axis.normal;
  if (axis.distance > margin) return 0;

  int count = 0;
  switch (axis.kind) {
  case FIRST_FACE:
    count = clipped_face(first, axis.first, second, &turn, offset, margin, 0, room, points);
    break;
  case SECOND_FACE:
    count = clipped_second_face(first, second, axis.second, &turn, offset, margin, room, points);
    break;
  case TWO_EDGES:
    points[count++] = crossing_edges(first, second, &axis, room);
    count += points_beside_edges(first, second, &axis, &turn, offset, margin, room, points + 1);
    break;
  }
  if (axis.kind != TWO_EDGES) {
    double deepest = INFINITY;
    for (int i = 0; i < count; i++) deepest = smaller(deepest, points[i].gap);
    if (deepest > axis.distance + favour) { /* the vertex that is deepest is beside the face: clipping has lost it */
      Vec3 half = scaled(axis.normal, axis.distance / 2), point;
      int vertex;
      if (axis.kind == FIRST_FACE) {
        vertex = hull_lowest_vertex(second, transposed_times(&turn, axis.normal));
        point = sub(add(times(&turn, hull_vertex(second, vertex)), offset), half);
      } else {
        vertex = hull_lowest_vertex(first, negated(axis.normal));
        point = add(hull_vertex(first, vertex), half);
      }
      points[count++] = (PairPoint){point, axis.distance, LOWEST_POINT | (uint64_t)vertex};
    }
  }
  count = chosen_points(points, count);
  for (int i = 0; i < count; i++) points[i].point = add(times(&a->axes, points[i].point), a->position);
  *normal = times(&a->axes, axis.normal);
  return count;
}
