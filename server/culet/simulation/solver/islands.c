/* Islands: stones that press on each other, which gain energy, fall asleep and wake together. */
#include "solver.h"

#define STILL 1e-3         /* sqrt(g size): a stone slower than this for STILL_SECONDS may sleep */
#define STILL_SECONDS 0.3
#define FIXED 5e-6         /* size: what a stone that leans may tremble, which only time tells from one that falls */
#define FIXED_TIME 3.0     /* sqrt(size / g): in this time what falls from a balance gets twenty times as far from it */
#define FIXED_SECONDS 0.5  /* at least */
#define WAKING 3e-2        /* sqrt(g size): what is slower does not wake a sleeper by touching it */
#define WAKING_GAP 1e-3    /* size */
#define SUPPORT_GAP 1e-4   /* size */
#define SUPPORT 1e-3       /* size: nearer to the edge of what carries it a stone is balancing */
#define THIN_SUPPORT 0.1   /* of the inradius, likewise: a needle lies on less than SUPPORT */
#define LEVEL 0.999        /* cosine: contacts more slanted than this do not make a level base */
#define MAX_FEET                                                                                                       \
  (2 * CULET_MAX_VERTICES) /* a hull lies on all of its vertices at most, and on a few points of others */

void separate_islands(World *world) {
  for (int i = 0; i < world->count; i++) world->courses[i].parent = i;
}

int island(World *world, int number) {
  Course *courses = world->courses;
  while (courses[number].parent != number) number = courses[number].parent = courses[courses[number].parent].parent;
  return number;
}

void join(World *world, int one, int other) { world->courses[island(world, one)].parent = island(world, other); }

static void wake(Body *body) {
  body->asleep = 0;
  body->still = body->fixed = 0;
}

/* With all that it fell asleep with, or that fell asleep on it. */
void wake_body(World *world, int number) {
  int32_t bed = world->bodies[number].bed;
  int slept = world->bodies[number].asleep;
  wake(&world->bodies[number]);
  for (int i = 0; slept && i < world->count; i++)
    if (world->bodies[i].asleep && world->bodies[i].bed == bed) wake(&world->bodies[i]);
}

static double speed(const Body *body) { return length(body->velocity) + length(body->spin) * body->size; }

/* Whether the whole body is slower than that, R/s; a needle may spin about its length. */
static int slower(const Body *body, double limit) {
  double along = length(body->velocity);
  if (along + length(body->spin) * body->size < limit) return 1;
  return along < limit && along + farthest_moved(body, body->spin) < limit;
}

/* Whether all of the body is nearer than that, R, to where it was when it began to stay. */
static int stays(const Body *body, double limit) {
  Quat q = body->fixed_orientation, turn = product(body->orientation, (Quat){q.w, -q.x, -q.y, -q.z});
  Vec3 angle = scaled(vec(turn.x, turn.y, turn.z), turn.w < 0 ? -2 : 2);
  double way = length(sub(body->position, body->fixed_position));
  if (way + length(angle) * body->size < limit) return 1;
  return way < limit && way + farthest_moved(body, angle) < limit;
}

static double fixed_seconds(const World *world, const Body *body) {
  return larger(FIXED_SECONDS, FIXED_TIME * sqrt(body->size / world->law.gravity));
}

/* Wakes sleepers that something moving has reached; whether there were any. */
int wake_touched(World *world) {
  int any = 0;
  for (int i = 0; i < world->now.manifold_count; i++) {
    const Manifold *manifold = &world->now.manifolds[i];
    if (manifold->other == NONE) continue;
    int sleeper = manifold->body, mover = manifold->other;
    if (!world->bodies[sleeper].asleep) {
      sleeper = manifold->other;
      mover = manifold->body;
    }
    const Body *body = &world->bodies[sleeper], *other = &world->bodies[mover];
    if (!body->asleep || other->asleep || other->held) continue;
    double gap = INFINITY, size = smaller(body->size, other->size);
    for (int k = 0; k < manifold->count; k++) gap = smaller(gap, world->now.contacts[manifold->first + k].gap);
    if (gap < WAKING_GAP * size && speed(other) > WAKING * sqrt(world->law.gravity * size))
      wake_body(world, sleeper), any = 1;
  }
  return any;
}

typedef enum { FALLS, LEANS, STANDS } Support;

/* Whether the origin is within the convex polygon of these points, and no nearer to its edges than `support`. The edges are
 * found one after the other (Jarvis 1973), with all points to their left. */
static int carried(const double *x, const double *z, int feet, double size, double support) {
  int start = 0, p;
  for (int i = 1; i < feet; i++)
    if (x[i] < x[start] || (x[i] == x[start] && z[i] < z[start])) start = i;
  p = start;
  for (int edges = 0; edges < feet; edges++) {
    int q = NONE;
    double ex = 0, ez = 0;
    for (int r = 0; r < feet; r++) {
      double rx = x[r] - x[p], rz = z[r] - z[p], squared = rx * rx + rz * rz, side = ex * rz - ez * rx;
      if (squared < 1e-18 * size * size) continue;
      if (q != NONE && (side > 0 || (side == 0 && squared <= ex * ex + ez * ez))) continue;
      q = r;
      ex = rx;
      ez = rz;
    }
    if (q == NONE) return 0; /* all in one point */
    if ((ez * x[p] - ex * z[p]) / sqrt(ex * ex + ez * ez) < support) return 0;
    p = q;
    if (p == start) break;
  }
  return 1;
}

/* STANDS if the centre of mass is above the polygon of the points that carry it, by SUPPORT: then no small push makes it
 * fall. LEANS if slanted contacts hold it, or walls and floor together. */
static Support support_of(const World *world, int number) {
  const Body *body = &world->bodies[number];
  double x[MAX_FEET], z[MAX_FEET];
  int feet = 0, slanted = 0;
  for (int i = 0; i < world->now.count && feet < MAX_FEET; i++) {
    const Contact *contact = &world->now.contacts[i];
    int given = contact->other == number;
    if ((contact->body != number && !given) || contact->gap > SUPPORT_GAP * body->size) continue;
    double up = given ? -contact->normal.y : contact->normal.y;
    int level = up >= LEVEL;
    if (!level && contact->normal_impulse <= 0) continue;
    slanted |= !level;
    Vec3 arm = given ? contact->other_arm : contact->arm;
    x[feet] = arm.x;
    z[feet++] = arm.z;
  }
  double support = smaller(SUPPORT * body->size, THIN_SUPPORT * body->hull.inradius);
  if (feet >= 3 && carried(x, z, feet, body->size, support)) return STANDS;
  return slanted && feet >= 2 ? LEANS : FALLS;
}

static double pressing(const World *world, const Manifold *manifold) {
  double sum = 0;
  for (int k = 0; k < manifold->count; k++) sum += world->now.contacts[manifold->first + k].normal_impulse;
  return sum;
}

void fall_asleep(World *world, double time) {
  Course *courses = world->courses;
  int any = 0;
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    if (body->asleep || body->held) continue;
    body->still = slower(body, STILL * sqrt(world->law.gravity * body->size)) ? body->still + time : 0;
    if (body->still > 0 && body->fixed > 0 && stays(body, FIXED * body->size))
      body->fixed += time;
    else {
      body->fixed = time;
      body->fixed_position = body->position;
      body->fixed_orientation = body->orientation;
    }
    any |= body->still >= STILL_SECONDS;
  }
  if (!any || !world->law.sleeping) return;
  separate_islands(world);
  for (int i = 0; i < world->now.manifold_count; i++) {
    const Manifold *manifold = &world->now.manifolds[i];
    if (manifold->other == NONE || world->bodies[manifold->body].held || world->bodies[manifold->other].held) continue;
    if (pressing(world, manifold) > 0) join(world, manifold->body, manifold->other);
  }
  for (int i = 0; i < world->count; i++) courses[i].restless = 0;
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    if (!body->asleep && !body->held && body->still < STILL_SECONDS) courses[island(world, i)].restless = 1;
  }
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    Course *whole = &courses[island(world, i)];
    if (body->asleep || body->held || whole->restless) continue;
    Support support = support_of(world, i);
    if (support == FALLS || (support == LEANS && body->fixed < fixed_seconds(world, body))) whole->restless = 1;
  }
  for (int i = 0; i < world->count; i++) courses[i].bed = -1;
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    int whole = island(world, i);
    if (body->asleep || body->held || courses[whole].restless) continue;
    if (courses[whole].bed < 0) courses[whole].bed = world->beds++;
    body->asleep = 1;
    body->bed = courses[whole].bed;
    body->velocity = body->angular_momentum = body->spin = ZERO;
  }
  /* sleepers on which others have fallen asleep: from now on one bed */
  for (int i = 0; i < world->count; i++) {
    int whole = island(world, i);
    int32_t old = world->bodies[i].bed, bed = courses[whole].bed;
    if (!world->bodies[i].asleep || bed < 0 || old == bed) continue;
    for (int k = 0; k < world->count; k++)
      if (world->bodies[k].asleep && world->bodies[k].bed == old) world->bodies[k].bed = bed;
  }
}
