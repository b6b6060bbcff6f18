// Beams of light with flat sides: convex polygons on a facet that a light went in by, or on one that it met inside, and what
// a scene's light needs besides. A work-item traces beams one by one, so there are no lanes here.
//
// DIVERGING 0: all rays of a beam share a direction. 1: those of a light at a point, where every corner has its own, and its
// place (a, b) on the facet that the light came in by, where the beam's flux is measured by area.
#ifndef CULET_LIGHT_BEAM
#define CULET_LIGHT_BEAM
#undef LANES
#define LANES 1
#include "parameters.cl"
#include "raster.cl"
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef DIVERGING
#define DIVERGING 0
#endif
#ifndef MOST_FACETS // of a stone
#define MOST_FACETS 96
#endif
#ifndef CORNERS
#define CORNERS 20            // of a beam, at most: a stone's facets have up to 16, and 20 were met
#endif
#define CLIPPED (CORNERS + 6) // of what is cut from it by the room's surfaces
#define BEAMS 128             // under way at a time; what does not fit is counted as cut
#define GRAZING ((real)1e-4)  // cosine below which light passes a surface by: it would land 1e4 R away

typedef struct {
  real p[3];
#if DIVERGING
  real d[3]; // of any length
  real a, b;
#endif
} corner_t;

// Where the light goes, and what it may do.
typedef struct {
  real surface[MAX_SURFACES][4];                     // inward normal and offset: the room is n.x >= offset
  real across[MAX_SURFACES][3], up[MAX_SURFACES][3]; // directions of a map's rows, and of its columns
  real centre[MAX_SURFACES][2];                      // of the maps, along these
  real half_size[MAP_LEVELS];                        // R
  real cutoff;                                       // flux of a beam that ends, R^2 of the brightest light
  real piece; // diameter of a beam at its beginning, in distances from a light at a point, at most
  int fresnel_kind;
  int present[MAX_SURFACES];
  int mapped[MAX_SURFACES]; // whether the surface has a map
  int maps, stones, lights, bands, entries, points, gauges;
  int sunk;                 // a stone reaches so far through a surface that what is beyond must not throw a shadow
} throwing_t;

// Light of one direction, or of one point.
typedef struct {
  real place[3];   // the unit vector towards a light at infinity, or where it is
  real squared;    // of a point's distance at which its irradiance is that of its colour
  float colour[4]; // irradiance over pi of a surface that faces it
  real dimness;    // how many times fainter its emitter is than the brightest
  int follows;     // into the stones, or else it only makes shadows
  int shade;       // number of a point's shadow
  int inside;      // number of the stone that a point is in, or -1
  int gauge;       // number of what it lets through into its shadows, or -1: its lamp makes no flecks
  int gauges;      // it is followed to find that out
} light_t;

// A convex stone, R, relative to the origin of these kernels' frame.
typedef struct {
  real centre[3], radius;
  int first_facet, facets;
  int first_plane, padded; // its planes: as many normals' x, then y, z, and offsets
  int first_vertex, vertices;
  int first_entry, last_entry;
  int first_chain;
  int pierces; // it reaches through a surface of the room
} solid_t;

// Of a solid's facets, how their corners follow each other, counter-clockwise seen from outside.
typedef struct {
  __global const real *planes;
  __global const real *vertices; // (V, 3)
  __global const int *start;     // of each facet's corners, and of one facet more
  __global const int *corners;   // numbers of vertices
  __global const int *across;    // the stone's facet beyond the side that begins at a corner
} facets_t;

// Flux in R^2 of the light's colour, mean of the channels.
typedef struct {
  double incident, landed, outside, away, behind, absorbed, cut, unresolved;
  double doubt; // of beams below three times the cut-off: irradiance x flux, on the inner map of a surface
  double beams;
} tally_t;

// Where a work-item accumulates what it throws: light, and for each point how far a texel is in its shadow; with the marks
// of both.
typedef struct {
  __global float4 *light;
  __global float *shade;
  __global uint *lit, *shaded;
} canvas_t;

static inline real dot_3(const real *a, const real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline void cross_3(const real *a, const real *b, real *c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}
static inline void normalise_3(real *a) {
  const real inverse = rsqrt(fmax(dot_3(a, a), (real)1e-30));
  for (int k = 0; k < 3; k++) a[k] *= inverse;
}
static inline real mix_of(real a, real b, real part) { return a + part * (b - a); }

// The direction of a beam's ray through a corner.
static inline const real *way_of(const corner_t *corner, const real *common) {
#if DIVERGING
  return corner->d;
#else
  return common;
#endif
}

static inline corner_t between(const corner_t *a, const corner_t *b, real part) {
  corner_t c;
  for (int k = 0; k < 3; k++) c.p[k] = mix_of(a->p[k], b->p[k], part);
#if DIVERGING
  for (int k = 0; k < 3; k++) c.d[k] = mix_of(a->d[k], b->d[k], part);
  c.a = mix_of(a->a, b->a, part);
  c.b = mix_of(a->b, b->b, part);
#endif
  return c;
}

// The part of a convex polygon where a function of its corners is not negative (Sutherland & Hodgman, Reentrant polygon
// clipping, 1974). Returns the number of its corners, `most` of them if there would be more.
static inline int clip_corners(const corner_t *from, int count, const real *inside, corner_t *to, int most) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    const int next = i + 1 == count ? 0 : i + 1;
    if (inside[i] >= 0 && kept < most) to[kept++] = from[i];
    if ((inside[i] < 0) != (inside[next] < 0) && kept < most)
      to[kept++] = between(from + i, from + next, inside[i] / (inside[i] - inside[next]));
  }
  return kept;
}

// A measure of a beam's flux: its area across its rays, but for a factor, or that on the facet it came in by.
static inline real measure(const corner_t *corners, int count) {
#if DIVERGING
  real area = 0;
  for (int i = 1; i + 1 < count; i++)
    area += (corners[i].a - corners[0].a) * (corners[i + 1].b - corners[0].b) -
            (corners[i + 1].a - corners[0].a) * (corners[i].b - corners[0].b);
  return fabs(area);
#else
  real sum[3] = {0, 0, 0};
  for (int i = 1; i + 1 < count; i++) {
    real e[3], f[3], c[3];
    for (int k = 0; k < 3; k++) {
      e[k] = corners[i].p[k] - corners[0].p[k];
      f[k] = corners[i + 1].p[k] - corners[0].p[k];
    }
    cross_3(e, f, c);
    for (int k = 0; k < 3; k++) sum[k] += c[k];
  }
  return sqrt(dot_3(sum, sum));
#endif
}

#endif
