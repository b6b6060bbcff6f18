/* How far two convex polyhedra are apart, or overlap: the separating axis test.
 *
 * Two convex polyhedra are apart just if a face normal of one of them, or the cross product of two edges, separates
 * them; the largest signed distance over these axes is, when negative, the least depth by which they can be moved out of
 * each other (Gottschalk 1996). Faces that cannot be the best are left out by the sphere that the other hull holds, and
 * by one of its vertices, which is no nearer to the face than the nearest; edges by their place: only those that reach
 * beyond the best face planes of the other can touch, and of these only pairs whose arcs on the Gauss map cross are edges
 * of the Minkowski difference (Gregorius 2013). */
#include "solver.h"

#define PARALLEL 1e-8 /* sine between edges: their cross product would have lost half its digits */

/* The best face of `first`; of the second at `offset`, turned by `turn`, all in the first one's axes. */
static double best_face(const Hull *first, const Hull *second, const Mat3 *turn, Vec3 offset, double at_least,
                        double enough, int backwards, PairRoom *room, int *face) {
  int highest = 0;
  for (int i = 0; i < first->face_count; i++) {
    room->heights[i] = dot(first->normal[i], offset) - first->offset[i];
    if (room->heights[i] > room->heights[highest]) highest = i;
  }
  double best = -INFINITY;
  Vec3 nearest = ZERO;           /* the second one's vertex that is lowest over the best face so far */
  for (int n = -1; n < first->face_count; n++) {
    int i = n < 0 ? highest : n; /* the most likely before all others */
    double height = room->heights[i], bound = height - second->inradius;
    if (n == highest || bound <= best || bound <= at_least) continue;
    Vec3 normal = first->normal[i];
    if (n >= 0 && dot(normal, nearest) - first->offset[i] <= larger(best, at_least)) continue;
    Vec3 there = backwards ? times(turn, normal) : transposed_times(turn, normal);
    double distance = height + hull_lowest(second, there, room->reaches);
    if (distance > best) {
      best = distance;
      *face = i;
      if (best > enough) break;
      Vec3 vertex = hull_vertex(second, hull_lowest_vertex(second, there));
      nearest = add(backwards ? transposed_times(turn, vertex) : times(turn, vertex), offset);
    }
  }
  return best;
}

/* The edges whose lower end is below a plane, or above it by `band` at most; the plane in the hull's own axes. */
static int edges_below(const Hull *hull, Vec3 normal, double offset, double band, double *reaches, int *edges) {
  int count = 0;
  hull_lowest(hull, normal, reaches);
  for (int i = 0; i < hull->edge_count; i++)
    if (smaller(reaches[hull->edges[i][0]], reaches[hull->edges[i][1]]) - offset <= band) edges[count++] = i;
  return count;
}

/* Above `enough` a lower bound. By less than `favour` (R) no axis is preferred to a face, which carries at several points,
 * nor the second one's face to the first one's: else the choice would flicker where faces lie on each other. */
Axis separation(const Hull *first, const Hull *second, const Mat3 *turn, Vec3 offset, double enough, double favour,
                PairRoom *room) {
  int face = 0, other_face = 0;
  double best = best_face(first, second, turn, offset, -INFINITY, enough, 0, room, &face);
  if (best > enough) return (Axis){best, FIRST_FACE, face, 0, first->normal[face]};
  Vec3 back = negated(transposed_times(turn, offset));
  double other_best = best_face(second, first, turn, back, best, enough, 1, room, &other_face);
  Vec3 other_normal = times(turn, second->normal[other_face]);
  if (other_best > enough) return (Axis){other_best, SECOND_FACE, 0, other_face, negated(other_normal)};

  for (int i = 0; i < second->vertex_count; i++) room->vertices[i] = add(times(turn, hull_vertex(second, i)), offset);
  double other_height = dot(other_normal, offset) + second->offset[other_face];
  int count = edges_below(first, other_normal, other_height, enough, room->reaches, room->edges);
  Vec3 there = transposed_times(turn, first->normal[face]);
  double height = first->offset[face] - dot(first->normal[face], offset);
  int other_count = edges_below(second, there, height, enough, room->reaches, room->other_edges);
  for (int j = 0; j < other_count; j++) {
    const int32_t *edge = second->edges[room->other_edges[j]];
    room->face[j] = negated(times(turn, second->normal[edge[2]]));
    room->other_face[j] = negated(times(turn, second->normal[edge[3]]));
  }
  Axis edges = {-INFINITY, TWO_EDGES, 0, 0, {0, 1, 0}};
  for (int i = 0; i < count; i++) {
    const int32_t *edge = first->edges[room->edges[i]];
    Vec3 a = first->normal[edge[2]], b = first->normal[edge[3]];
    Vec3 p = hull_vertex(first, edge[0]), along = sub(hull_vertex(first, edge[1]), p);
    Vec3 b_a = cross(b, a);
    for (int j = 0; j < other_count; j++) {
      Vec3 c = room->face[j], d = room->other_face[j];
      double cba = dot(c, b_a), dba = dot(d, b_a);
      if (cba * dba >= 0) continue;
      Vec3 d_c = cross(d, c);
      double adc = dot(a, d_c), bdc = dot(b, d_c);
      if (adc * bdc >= 0 || cba * bdc <= 0) continue;
      const int32_t *other_edge = second->edges[room->other_edges[j]];
      Vec3 q = room->vertices[other_edge[0]], other_along = sub(room->vertices[other_edge[1]], q);
      Vec3 normal = cross(along, other_along);
      double size = length(normal);
      if (size <= PARALLEL * sqrt(dot(along, along) * dot(other_along, other_along))) continue;
      normal = scaled(normal, dot(normal, p) < 0 ? -1 / size : 1 / size); /* away from the centre of mass */
      double distance = dot(normal, sub(q, p));
      if (distance > edges.distance) edges = (Axis){distance, TWO_EDGES, room->edges[i], room->other_edges[j], normal};
    }
  }
  double chosen = best >= other_best - favour ? best : other_best;
  if (edges.distance > chosen + favour) return edges;
  if (chosen == best) return (Axis){best, FIRST_FACE, face, 0, first->normal[face]};
  return (Axis){other_best, SECOND_FACE, 0, other_face, negated(other_normal)};
}
