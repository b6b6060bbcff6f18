// The shadows of convex stones: what stands between a light and the room is taken from the light of floor and walls.
#ifndef CULET_LIGHT_SHADOW
#define CULET_LIGHT_SHADOW
#include "exchange.cl"

#define NO_CORNER 0xffff
#define NO_OUTLINE (-1)

// A polygon of the stone's surface, seen by the light, takes its light from wherever its rays would have gone on to.
static inline void shade(const job_t *job, corner_t *corners, int count) {
  tally_t none = {0};
  real common[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) common[k] = -job->light->place[k];
#if DIVERGING
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) corners[i].d[k] = corners[i].p[k] - job->light->place[k];
#endif
  land(job->room, job->canvas, &none, job->light, corners, count, common, 0, job->colour, 1, 1, 0, SHADOW_OF_LIGHT);
}

// The outline of a stone, from its lit facets' sides to unlit ones, counter-clockwise seen from the light: numbers of its own
// vertices. Returns their number; NO_OUTLINE unless that is one closed line, which it is but for facets that are seen edge-on.
static inline int outline_of(const job_t *job, ushort *outline) {
  ushort following[2 * MOST_FACETS];
  const int base = job->solid->first_vertex;
  for (int i = 0; i < job->solid->vertices; i++) following[i] = NO_CORNER;
  int sides = 0, begins = 0;
  ulong lit[MOST_FACETS / 64 + 1];
  for (int i = 0; i <= MOST_FACETS / 64; i++) lit[i] = 0;
  for (int f = 0; f < job->solid->facets; f++) lit[f >> 6] |= (ulong)is_lit(job, f) << (f & 63);
  for (int f = 0; f < job->solid->facets; f++) {
    if (!(lit[f >> 6] >> (f & 63) & 1)) continue;
    const int begin = job->facets.start[job->solid->first_facet + f],
              end = job->facets.start[job->solid->first_facet + f + 1];
    for (int e = begin; e < end; e++) {
      const int beyond = job->facets.across[e];
      if (lit[beyond >> 6] >> (beyond & 63) & 1) continue;
      const int from = job->facets.corners[e] - base, to = job->facets.corners[e + 1 == end ? begin : e + 1] - base;
      if (following[from] != NO_CORNER) return NO_OUTLINE;
      following[from] = to;
      begins = from;
      sides++;
    }
  }
  if (sides < 3) return sides == 0 ? 0 : NO_OUTLINE;
  int at = begins;
  for (int i = 0; i < sides; i++) {
    outline[i] = at;
    at = following[at];
    if (at == NO_CORNER || (at == begins && i + 1 < sides)) return NO_OUTLINE;
  }
  return at == begins ? sides : NO_OUTLINE;
}

// The shadow of all that a stone's outline surrounds. Returns whether it has one.
static inline int shade_outline(const job_t *job) {
  ushort outline[2 * MOST_FACETS];
  const int sides = outline_of(job, outline);
  corner_t corner[CORNERS];
  for (int first = 1; first + 1 < sides; first += CORNERS - 2) { // parts of it, as a fan about its first corner
    const int count = 1 + min(CORNERS - 1, sides - first);
    for (int i = 0; i < count; i++)
      for (int k = 0; k < 3; k++)
        corner[i].p[k] = job->facets.vertices[3 * (job->solid->first_vertex + outline[i == 0 ? 0 : first + i - 1]) + k];
    shade(job, corner, count);
  }
  return sides != NO_OUTLINE;
}

#if SEVERAL && !DIVERGING
// What several stones hide of parallel light is what the union of their outlines hides, as long as all of them are in the
// room: so each stone takes, of what lies in its outline, what lies in none of an earlier stone. All that is flat, seen along
// the light.
#define FACE_CORNERS 40 // of a part, at most
#define FAN 16          // of a part at first
#define FACES 96        // parts of an outline, at most; what does not fit stays lit

typedef struct {
  real x[FACE_CORNERS], y[FACE_CORNERS];
  int count;
} face_t;

// Two axes across the light: x to y counter-clockwise seen from it. `height` is before all stones.
typedef struct {
  real x[3], y[3], towards[3], height;
} view_t;

static inline view_t view_of(const job_t *job) {
  view_t view;
  const real *d = view.towards;
  for (int k = 0; k < 3; k++) view.towards[k] = job->light->place[k];
  const int steep = fabs(d[1]) > (real)0.7;
  const real other[3] = {steep ? 1 : 0, steep ? 0 : 1, 0};
  cross_3(other, d, view.x);
  normalise_3(view.x);
  cross_3(d, view.x, view.y);
  view.height = -1e30f;
  for (int s = 0; s < job->room->stones; s++) {
    const real centre[3] = {job->solids[s].centre[0], job->solids[s].centre[1], job->solids[s].centre[2]};
    view.height = fmax(view.height, dot_3(centre, d) + job->solids[s].radius);
  }
  return view;
}

static inline void see(const job_t *job, const view_t *view, int vertex, real *x, real *y) {
  const real p[3] = {job->facets.vertices[3 * vertex], job->facets.vertices[3 * vertex + 1],
                     job->facets.vertices[3 * vertex + 2]};
  *x = dot_3(view->x, p);
  *y = dot_3(view->y, p);
}

// The part of a face left of a line (x, y) + t (along_x, along_y), or right of it.
static inline int cut_face(const face_t *from, real x, real y, real along_x, real along_y, face_t *to) {
  int kept = 0;
  const int count = from->count;
  real now = along_x * (from->y[0] - y) - along_y * (from->x[0] - x);
  for (int i = 0; i < count; i++) {
    const int next = i + 1 == count ? 0 : i + 1;
    const real then = along_x * (from->y[next] - y) - along_y * (from->x[next] - x);
    if (now >= 0 && kept < FACE_CORNERS) {
      to->x[kept] = from->x[i];
      to->y[kept++] = from->y[i];
    }
    if ((now < 0) != (then < 0) && kept < FACE_CORNERS) {
      const real part = now / (now - then);
      to->x[kept] = mix_of(from->x[i], from->x[next], part);
      to->y[kept++] = mix_of(from->y[i], from->y[next], part);
    }
    now = then;
  }
  to->count = kept;
  return kept;
}

// Takes from each of the faces what is within a convex outline. Returns how many there are then.
static inline int take_from(face_t *faces, int waiting, const real *x, const real *y, int sides) {
  for (int number = waiting - 1; number >= 0; number--) {
    const int before = waiting;
    face_t now[2];
    int side = 0;
    now[0] = faces[number];
    for (int i = 0; i < sides; i++) {
      const int next = i + 1 == sides ? 0 : i + 1;
      const real along_x = x[next] - x[i], along_y = y[next] - y[i];
      int out = 0;
      for (int k = 0; k < now[side].count; k++)
        out += along_x * (now[side].y[k] - y[i]) - along_y * (now[side].x[k] - x[i]) < 0;
      if (!out) continue;
      if (out < now[side].count) {
        if (waiting < FACES && cut_face(now + side, x[i], y[i], -along_x, -along_y, faces + waiting) > 2) waiting++;
        cut_face(now + side, x[i], y[i], along_x, along_y, now + 1 - side);
        side = 1 - side;
      } else
        now[side].count = 0;
      if (now[side].count < 3) break;
    }
    if (now[side].count < 3)
      waiting = before; // it lies outside
    else if (number < --waiting)
      faces[number] = faces[waiting];
  }
  return waiting;
}

// The shadow of faces of one stone where none of an earlier stone is in it already.
static inline void shade_faces(job_t *job, const view_t *view, face_t *faces, int waiting) {
  const int own = job->solid - job->solids;
  const real centre[3] = {job->solid->centre[0], job->solid->centre[1], job->solid->centre[2]};
  for (int s = 0; s < own && waiting > 0; s++) {
    real apart[3];
    for (int k = 0; k < 3; k++) apart[k] = job->solids[s].centre[k] - centre[k];
    const real x = dot_3(view->x, apart), y = dot_3(view->y, apart),
               reach = job->solids[s].radius + job->solids[own].radius;
    if (x * x + y * y >= reach * reach) continue;
    go_to(job, s);
    ushort outline[2 * MOST_FACETS];
    real qx[2 * MOST_FACETS], qy[2 * MOST_FACETS];
    const int sides = outline_of(job, outline);
    for (int i = 0; i < sides; i++) see(job, view, job->solid->first_vertex + outline[i], qx + i, qy + i);
    if (sides != NO_OUTLINE)
      waiting = take_from(faces, waiting, qx, qy, sides);
    else
      for (int f = 0; f < job->solid->facets; f++) {
        if (!is_lit(job, f)) continue;
        const int begin = job->facets.start[job->solid->first_facet + f],
                  count = job->facets.start[job->solid->first_facet + f + 1] - begin;
        for (int i = 0; i < count; i++) see(job, view, job->facets.corners[begin + i], qx + i, qy + i);
        waiting = take_from(faces, waiting, qx, qy, count);
      }
  }
  go_to(job, own);
  for (int number = 0; number < waiting; number++) {
    corner_t corner[CORNERS];
    const face_t *face = faces + number;
    for (int first = 1; first + 1 < face->count; first += CORNERS - 2) {
      const int count = 1 + min(CORNERS - 1, face->count - first);
      for (int i = 0; i < count; i++) {
        const int at = i == 0 ? 0 : first + i - 1;
        for (int k = 0; k < 3; k++)
          corner[i].p[k] = view->x[k] * face->x[at] + view->y[k] * face->y[at] + view->towards[k] * view->height;
      }
      shade(job, corner, count);
    }
  }
}

// The shadow of a stone where no earlier stone's is.
static inline void shade_beyond_earlier(job_t *job) {
  const view_t view = view_of(job);
  ushort outline[2 * MOST_FACETS];
  face_t faces[FACES];
  const int sides = outline_of(job, outline);
  if (sides != NO_OUTLINE) {
    int waiting = 0;
    for (int first = 1; first + 1 < sides; first += FAN - 2) { // a fan about the first corner
      face_t *face = faces + min(waiting++, FACES - 1);
      face->count = 1 + min(FAN - 1, sides - first);
      for (int i = 0; i < face->count; i++)
        see(job, &view, job->solid->first_vertex + outline[i == 0 ? 0 : first + i - 1], face->x + i, face->y + i);
    }
    shade_faces(job, &view, faces, waiting);
    return;
  }
  for (int f = 0; f < job->solid->facets; f++) {
    if (!is_lit(job, f)) continue;
    const int begin = job->facets.start[job->solid->first_facet + f],
              count = job->facets.start[job->solid->first_facet + f + 1] - begin;
    for (int first = 1; first + 1 < count; first += FAN - 2) {
      faces[0].count = 1 + min(FAN - 1, count - first);
      for (int i = 0; i < faces[0].count; i++)
        see(job, &view, job->facets.corners[begin + (i == 0 ? 0 : first + i - 1)], faces[0].x + i, faces[0].y + i);
      shade_faces(job, &view, faces, 1);
    }
  }
}
#endif

// The parts of a facet that the light reaches past the other stones.
static inline void begin_lighting(const job_t *job, const corner_t *corners, int count, flight_t *flight) {
  begin_flight(flight, corners, count, job->solid - job->solids);
#if DIVERGING
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) flight->piece[0].corner[i].d[k] = job->light->place[k] - corners[i].p[k];
#endif
}

// The next of them. Returns whether there is one.
static inline int next_lit(const job_t *job, flight_t *flight, piece_t *part) {
  const real towards[3] = {job->light->place[0], job->light->place[1], job->light->place[2]};
  while (flight->waiting > 0) {
    real limit = 1e30f;
#if DIVERGING
    real way[3];
    for (int k = 0; k < 3; k++) way[k] = towards[k] - flight->piece[flight->waiting - 1].corner[0].p[k];
    limit = sqrt(dot_3(way, way));
#endif
    if (next_part(job, flight, towards, limit, part) == NOBODY) return 1;
  }
  return 0;
}

#endif
