/* What the solver's files share: hulls, bodies, contacts, and the world that holds them. */
#ifndef CULET_WORLD_H
#define CULET_WORLD_H

#include "culet_solver.h"
#include "vector.h"

#define MAX_FACES (2 * CULET_MAX_VERTICES)
#define MAX_EDGES (3 * CULET_MAX_VERTICES)
#define MAX_CORNERS (2 * CULET_MAX_VERTICES + 8) /* of one face clipped by another */
#define NONE (-1)                                /* in place of a body: a surface */
#define PAIR_POINTS 8                            /* of one pair: four carry, the others are near */

/* Smaller than this in units of the smaller stone's size, two stones are near enough for a contact in any case. */
#define MARGIN 1e-3
/* R of the smaller stone. Overlap that is left as it is: pushing it out would make contacts come and go. */
#define SLOP 1e-5
/* Of the smaller inradius. Nearer to each other, two points of a pair are taken for one. */
#define SAME 0.1

typedef struct {
  int vertex_count, face_count, edge_count;
  double radius;   /* of the sphere about the centre of mass that holds the hull */
  double inradius; /* of the sphere about it that the hull holds */
  double *x, *y, *z;
  Vec3 *normal;
  double *offset;
  int32_t *first, *corners;
  int32_t (*edges)[4]; /* both ends, both faces */
} Hull;

typedef struct {
  Vec3 position, velocity, angular_momentum;
  Quat orientation;
  /* of the orientation and the angular momentum */
  Vec3 spin;
  Mat3 axes;
  /* what a substep takes for the mass: 0 where the body cannot move */
  double inverse_mass;
  Mat3 world_inverse_inertia;

  Hull hull;
  double size; /* the hull's radius, the unit of this body's small lengths */
  double mass, restitution, friction;
  Mat3 inertia, inverse_inertia, principal;
  double moments[3];

  int asleep, held;
  int32_t bed;  /* what fell asleep together, or onto what slept, wakes together */
  double still; /* s, since when it hardly moves */
  double fixed; /* s, since when it stays where it was then */
  Vec3 fixed_position;
  Quat fixed_orientation;
} Body;

/* One point where a body touches, or is about to touch, a surface or another body. Impulses are on `body`; `other` gets
 * the opposite. */
typedef struct {
  int body, other;
  Vec3 normal; /* towards `body` */
  Vec3 arm, other_arm;
  double gap;
  uint64_t feature; /* by which the contact is found again */
  double normal_impulse;
  Vec3 slip_impulse;
  Vec3 turning, other_turning; /* change of spin by a unit impulse along the normal */
  double normal_mass, slip_mass;
  double restitution, friction;
  int bounces;
  double arrival; /* velocity along the normal at the moment of touch */
  double target;  /* velocity along the normal that the impulse sees to */
  double push;    /* that moves an overlap apart */
  double kept_normal;
  Vec3 kept_slip;
} Contact;

/* All contacts of a body with one surface or one other body. */
typedef struct {
  int body, other, surface;
  int first, count;
  double rolling;      /* lever arm, R */
  double rolling_mass;
  double rolling_part; /* of the lever arm that acts at this speed */
  Vec3 rolling_impulse;
} Manifold;

typedef struct {
  Contact *contacts;
  Manifold *manifolds;
  int count, capacity, manifold_count, manifold_capacity;
} Contacts;

typedef struct {
  Vec3 normal;
  double offset;
} Surface;

/* What one substep needs of each body. */
typedef struct {
  Vec3 velocity;                     /* at its start */
  Vec3 pushed_velocity, pushed_spin; /* with gravity, before the contacts */
  Vec3 first_velocity, first_spin;   /* with the first answer of two */
  double kinetic;                    /* energy before the contacts */
  double touch;                      /* s into the substep; below 0: it touches nothing that bounces */
  int touched;
  Vec3 shift, turn;                  /* apart from what overlaps */
  int parent;                        /* in its island's tree */
  double gain, scale, square, linear, constant, part;
  int restless;
  int32_t bed; /* of the island that falls asleep; below 0: it does not */
} Course;

/* One of the points of a pair. */
typedef struct {
  Vec3 point;
  double gap;
  uint64_t feature;
} PairPoint;

/* Room for what one pair needs. */
typedef struct {
  double heights[MAX_FACES];
  double reaches[CULET_MAX_VERTICES];
  int edges[MAX_EDGES], other_edges[MAX_EDGES];
  Vec3 vertices[CULET_MAX_VERTICES];
  Vec3 face[MAX_EDGES], other_face[MAX_EDGES];
  Vec3 polygon[MAX_CORNERS], clipped[MAX_CORNERS];
  uint32_t names[MAX_CORNERS], clipped_names[MAX_CORNERS]; /* of the corners */
  uint32_t sides[MAX_CORNERS], clipped_sides[MAX_CORNERS]; /* that begin there */
  PairPoint points[MAX_CORNERS + 1];
} PairRoom;

struct CuletWorld {
  CuletLaw law;
  Surface surfaces[CULET_MAX_SURFACES];
  int surface_count;
  Body *bodies;
  int count, capacity;
  Course *courses;
  Contacts now, before;         /* of this substep; of the last one that was long enough to tell what carries what */
  double now_time, before_time; /* s: how long these substeps are */
  int now_is_short;             /* too short to tell */
  Vec3 *separating; /* (capacity, capacity): an axis that separated the pair lately, in the first one's axes */
  PairRoom *room;
  int32_t beds;
};

typedef struct CuletWorld World;

/* The axis that separates a pair best. */
typedef enum { FIRST_FACE, SECOND_FACE, TWO_EDGES } AxisKind;

typedef struct {
  double distance;
  AxisKind kind;
  int first, second; /* face, or edges */
  Vec3 normal;       /* in the first one's axes, from the first to the second */
} Axis;

/* hull.c */
int hull_copy(Hull *hull, const CuletHull *given);
void hull_free(Hull *hull);
double hull_lowest(const Hull *hull, Vec3 direction, double *reaches);
int hull_lowest_vertex(const Hull *hull, Vec3 direction);
static inline Vec3 hull_vertex(const Hull *hull, int i) { return vec(hull->x[i], hull->y[i], hull->z[i]); }

/* separation.c */
Axis separation(const Hull *first, const Hull *second, const Mat3 *turn, Vec3 offset, double enough, double favour,
                PairRoom *room);

/* manifold.c */
int pair_points(World *world, int one, int other, double margin, Vec3 *normal);
void pair_pose(const Body *first, const Body *second, Mat3 *turn, Vec3 *offset);

/* contacts.c */
int find_contacts(World *world, double time);
const Contacts *telling_contacts(const World *world);
int reserve_contacts(Contacts *contacts, int count, int manifold_count);
Vec3 contact_velocity(const World *world, const Contact *contact);

/* impulses.c */
void solve_impulses(World *world, double time, int warm, int bouncing);

/* energy.c */
double kinetic_energy(const Body *body);
void limit_energy(World *world, double time);

/* rotation.c */
void refresh(Body *body);
Vec3 angular_momentum_of(const Body *body, Vec3 spin);
double farthest_moved(const Body *body, Vec3 turn);
void rotate_freely(Body *body, double time);

/* motion.c */
int bounces_of(World *world, double time);
void kick(World *world, double time);
void move(World *world, double time);
void push_apart(World *world);

/* islands.c */
void separate_islands(World *world);
int island(World *world, int number);
void join(World *world, int one, int other);
void wake_body(World *world, int number);
int wake_touched(World *world);
void fall_asleep(World *world, double time);

#endif
