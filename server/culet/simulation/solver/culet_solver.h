/* The solver's interface: what Python calls by ctypes (interface.py has the same structures).
 *
 * Lengths in R, seconds, radians; the mass has no unit. A world has no state outside itself: worlds may be stepped by
 * several threads at once, one world by one thread at a time. Bodies have the numbers 0 to count - 1, in the order in
 * which they were added; removing one moves those after it down by one. */
#ifndef CULET_SOLVER_H
#define CULET_SOLVER_H

#include <stddef.h>
#include <stdint.h>

#define CULET_INTERFACE 5       /* changes whenever a structure or a function of this file does */

#define CULET_MAX_VERTICES 1024 /* of a hull: bounds the work and the memory of one pair */
#define CULET_MAX_SURFACES 16

#define CULET_API __attribute__((visibility("default")))

typedef struct CuletWorld CuletWorld;

typedef struct {
  double gravity;            /* downward, R/s^2 */
  double bounce_speed;       /* a slower touch does not bounce; in sqrt(g size of the smaller stone) */
  double contact_step;       /* longest substep, in sqrt(size of the smallest stone / g) */
  double rolling_resistance; /* lever arm, in sizes of the stone */
  int32_t sleeping;          /* whether what is at rest is left out */
  int32_t substeps;          /* of a step, at least */
  int32_t sweeps;            /* over all contacts in a substep, at most */
} CuletLaw;

/* A convex polyhedron about its centre of mass, in the body's axes. */
typedef struct {
  int32_t vertex_count, face_count, edge_count;
  const double *vertices; /* (vertex_count, 3) */
  const double *planes;   /* (face_count, 4) outward unit normal and offset */
  const int32_t *first;   /* (face_count + 1,) where each face's corners begin in `corners` */
  const int32_t *corners; /* vertices about each face, counter-clockwise seen from outside */
  const int32_t *edges;   /* (edge_count, 4) both ends and the two faces */
} CuletHull;

typedef struct {
  double mass;
  double inertia[9], inverse_inertia[9]; /* about the centre of mass, in the body's axes */
  double axes[9];                        /* principal axes by rows, the smallest moment first */
  double moments[3];
  double restitution, friction;
} CuletBody;

typedef struct {
  double position[3], orientation[4], velocity[3], angular_momentum[3], spin[3];
  int32_t asleep, held;
} CuletState;

typedef struct {
  int32_t contacts;   /* points that touch, or are nearer than 1e-6 R */
  double penetration; /* of the deepest of them, R */
} CuletTouch;

/* How a stone by itself is turned, and moves. */
typedef struct {
  double orientation[4], momentum[3], angular_momentum[3];
} CuletMotion;

/* A vertex of a stone by itself that touches a surface. */
typedef struct {
  double arm[3], normal[3]; /* from the centre of mass, R; towards the stone */
  double mass[6];           /* inverse of K, which takes an impulse to the vertex's velocity: xx, yy, zz, xy, xz, yz */
  double normal_inverse_mass; /* n . K n */
  double slip_mass;           /* 1 / trace of K across the normal: a step against slip that never overshoots */
  double target;              /* velocity along the normal that the impulse sees to, R/s */
  double impulse[3];          /* is found */
} CuletPoint;

CULET_API int32_t culet_interface(void);

/* NULL if there is no memory. */
CULET_API CuletWorld *culet_world_new(int32_t capacity);
CULET_API void culet_world_free(CuletWorld *world);

/* These wake all stones, as do `remove`, `set_body`, `set_state` and `hold`: what slept may have lost what carried it. */
CULET_API void culet_world_set_law(CuletWorld *world, const CuletLaw *law);
CULET_API void culet_world_set_surfaces(CuletWorld *world, int32_t count, const double *planes); /* (count, 4) */

/* The new body's number; -1 if there is no memory, -2 if the world is full or the hull too large. */
CULET_API int32_t culet_world_add(CuletWorld *world, const CuletHull *hull, const CuletBody *body,
                                  const CuletState *state);
CULET_API void culet_world_remove(CuletWorld *world, int32_t number);
/* Another mass, inertia, restitution or friction; velocity and spin stay. */
CULET_API void culet_world_set_body(CuletWorld *world, int32_t number, const CuletBody *body);
/* Another pose, velocity and angular momentum; `spin` is not read. */
CULET_API void culet_world_set_state(CuletWorld *world, int32_t number, const CuletState *state);
/* A body that is held does not move, and stops what touches it. */
CULET_API void culet_world_hold(CuletWorld *world, int32_t number, int32_t held);
/* An impulse at a point of the world. */
CULET_API void culet_world_push(CuletWorld *world, int32_t number, const double impulse[3], const double point[3]);
CULET_API void culet_world_wake(CuletWorld *world);

/* All bodies move on by `time` seconds; 0, or -1 if there is no memory: then bodies are where they had come to. */
CULET_API int32_t culet_world_step(CuletWorld *world, double time);

CULET_API void culet_world_states(const CuletWorld *world, CuletState *states);
/* As of the last step: of a body that was asleep in it, nothing. */
CULET_API void culet_world_touches(const CuletWorld *world, CuletTouch *touches);

/* All that the future depends on besides law, surfaces and bodies. `save` needs `size` bytes; `load` returns -1, and
 * changes nothing, if these are not of this number of bodies and surfaces, -2 if there is no memory. */
CULET_API size_t culet_world_size(const CuletWorld *world);
CULET_API void culet_world_save(const CuletWorld *world, void *bytes);
CULET_API int32_t culet_world_load(CuletWorld *world, const void *bytes, size_t size);

/* Signed distance of two bodies along the best of all axes: negative is the depth by which they overlap, exactly. Above
 * `enough` a lower bound. `axis` becomes that axis, of length 1, in the world, from the one towards the other. */
CULET_API double culet_world_separation(CuletWorld *world, int32_t one, int32_t other, double enough, double axis[3]);

/* One stone's impulses, and its momenta after them; 0, or -1, and nothing changed, if there is no memory. */
CULET_API int32_t culet_stone_impulses(const CuletBody *body, CuletMotion *motion, int32_t count, CuletPoint *points,
                                       double friction);

#endif
