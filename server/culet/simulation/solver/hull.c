/* Convex polyhedra: what a body's contacts are made of. */
#include "solver.h"

#include <stdlib.h>
#include <string.h>

static double *copy_of_doubles(const double *source, int count, int stride, int at) {
  double *copy = malloc(sizeof(double) * (size_t)count);
  if (copy)
    for (int i = 0; i < count; i++) copy[i] = source[stride * i + at];
  return copy;
}

static void *copy_of(const void *source, size_t size) {
  void *copy = malloc(size);
  if (copy) memcpy(copy, source, size);
  return copy;
}

/* 0; -1 if there is no memory, -2 if the hull is too large. */
int hull_copy(Hull *hull, const CuletHull *given) {
  memset(hull, 0, sizeof *hull);
  int vertices = given->vertex_count, faces = given->face_count, edges = given->edge_count;
  if (vertices < 4 || faces < 4 || edges < 6 || vertices > CULET_MAX_VERTICES || faces > MAX_FACES || edges > MAX_EDGES)
    return -2;
  for (int face = 0; face < faces; face++)
    if (given->first[face + 1] - given->first[face] > CULET_MAX_VERTICES) return -2;
  hull->vertex_count = vertices;
  hull->face_count = faces;
  hull->edge_count = edges;
  hull->x = copy_of_doubles(given->vertices, vertices, 3, 0);
  hull->y = copy_of_doubles(given->vertices, vertices, 3, 1);
  hull->z = copy_of_doubles(given->vertices, vertices, 3, 2);
  hull->offset = copy_of_doubles(given->planes, faces, 4, 3);
  hull->normal = malloc(sizeof(Vec3) * (size_t)faces);
  hull->first = copy_of(given->first, sizeof(int32_t) * (size_t)(faces + 1));
  hull->corners = copy_of(given->corners, sizeof(int32_t) * (size_t)given->first[faces]);
  hull->edges = copy_of(given->edges, sizeof(int32_t[4]) * (size_t)edges);
  if (!hull->x || !hull->y || !hull->z || !hull->offset || !hull->normal || !hull->first || !hull->corners ||
      !hull->edges) {
    hull_free(hull);
    return -1;
  }
  hull->inradius = INFINITY;
  for (int i = 0; i < faces; i++) {
    const double *plane = given->planes + 4 * i;
    hull->normal[i] = vec(plane[0], plane[1], plane[2]);
    hull->inradius = smaller(hull->inradius, plane[3]);
  }
  for (int i = 0; i < vertices; i++) hull->radius = larger(hull->radius, length(hull_vertex(hull, i)));
  return 0;
}

void hull_free(Hull *hull) {
  free(hull->x);
  free(hull->y);
  free(hull->z);
  free(hull->normal);
  free(hull->offset);
  free(hull->first);
  free(hull->corners);
  free(hull->edges);
  memset(hull, 0, sizeof *hull);
}

/* How far the hull reaches along a direction, at its lowest. Four minima, so that a compiler can take several at once
 * without another order: the smallest is the same in any. */
double hull_lowest(const Hull *hull, Vec3 direction, double *reaches) {
  const double *x = hull->x, *y = hull->y, *z = hull->z;
  int count = hull->vertex_count, i = 0;
  for (int k = 0; k < count; k++) reaches[k] = x[k] * direction.x + y[k] * direction.y + z[k] * direction.z;
  double a = reaches[0], b = a, c = a, d = a;
  for (; i + 3 < count; i += 4) {
    a = smaller(reaches[i], a);
    b = smaller(reaches[i + 1], b);
    c = smaller(reaches[i + 2], c);
    d = smaller(reaches[i + 3], d);
  }
  for (; i < count; i++) a = smaller(reaches[i], a);
  return smaller(smaller(a, b), smaller(c, d));
}

int hull_lowest_vertex(const Hull *hull, Vec3 direction) {
  int lowest = 0;
  double least = INFINITY;
  for (int i = 0; i < hull->vertex_count; i++) {
    double reach = hull->x[i] * direction.x + hull->y[i] * direction.y + hull->z[i] * direction.z;
    if (reach < least) {
      least = reach;
      lowest = i;
    }
  }
  return lowest;
}
