/* The world: what is in it, and a step of it.
 *
 * A step is divided into equal substeps, short enough for the fastest body (Macklin et al. 2019, "Small steps in physics
 * simulation": many substeps of few sweeps are better than few of many). */
#include "solver.h"

#include <stdlib.h>
#include <string.h>

#define REACH 0.05      /* of the inradius: how far a body may move in a substep */
#define MAX_SUBSTEPS 64 /* of a step: contacts ahead see to it that nothing is passed through even so */
#define MAX_FURTHER 256 /* substeps of a step, for bodies so thin that it takes more to see where they touch */
#define PACE 0.5        /* of two bodies' inradii: that they come nearer by in a substep without being looked at */
#define NEAR 0.1        /* of the smaller inradius: two bodies that are so near are about to touch */
#define TELLING 0.125   /* of an undivided substep: a shorter part tells little of what carries what */
#define TOUCHING 1e-6   /* size: what is nearer counts as touching */
#define FIRST_CONTACTS 256

int32_t culet_interface(void) { return CULET_INTERFACE; }

CuletWorld *culet_world_new(int32_t capacity) {
  World *world = calloc(1, sizeof *world);
  if (!world) return NULL;
  size_t n = (size_t)capacity;
  world->capacity = capacity;
  world->bodies = calloc(n, sizeof(Body));
  world->courses = calloc(n, sizeof(Course));
  world->separating = calloc(n * n, sizeof(Vec3));
  world->room = calloc(1, sizeof(PairRoom));
  if (!world->bodies || !world->courses || !world->separating || !world->room ||
      reserve_contacts(&world->now, FIRST_CONTACTS, FIRST_CONTACTS) ||
      reserve_contacts(&world->before, FIRST_CONTACTS, FIRST_CONTACTS)) {
    culet_world_free(world);
    return NULL;
  }
  return world;
}

void culet_world_free(CuletWorld *world) {
  if (!world) return;
  for (int i = 0; i < world->count; i++) hull_free(&world->bodies[i].hull);
  free(world->bodies);
  free(world->courses);
  free(world->separating);
  free(world->room);
  free(world->now.contacts);
  free(world->now.manifolds);
  free(world->before.contacts);
  free(world->before.manifolds);
  free(world);
}

void culet_world_wake(CuletWorld *world) {
  for (int i = 0; i < world->count; i++) wake_body(world, i);
}

void culet_world_set_law(CuletWorld *world, const CuletLaw *law) {
  world->law = *law;
  culet_world_wake(world);
}

/* Forgets impulses of contacts that are no more, or are other ones. */
static void forget_surfaces(Contacts *contacts) {
  int left = 0;
  for (int i = 0; i < contacts->manifold_count; i++)
    if (contacts->manifolds[i].other != NONE) contacts->manifolds[left++] = contacts->manifolds[i];
  contacts->manifold_count = left;
}

void culet_world_set_surfaces(CuletWorld *world, int32_t count, const double *planes) {
  world->surface_count = count < CULET_MAX_SURFACES ? count : CULET_MAX_SURFACES;
  for (int i = 0; i < world->surface_count; i++)
    world->surfaces[i] = (Surface){vec(planes[4 * i], planes[4 * i + 1], planes[4 * i + 2]), planes[4 * i + 3]};
  forget_surfaces(&world->now);
  forget_surfaces(&world->before);
  culet_world_wake(world);
}

static Mat3 matrix(const double m[9]) { return (Mat3){{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}}; }

static void take_properties(Body *body, const CuletBody *given) {
  body->mass = given->mass;
  body->inertia = matrix(given->inertia);
  body->inverse_inertia = matrix(given->inverse_inertia);
  body->principal = matrix(given->axes);
  memcpy(body->moments, given->moments, sizeof body->moments);
  body->restitution = given->restitution;
  body->friction = given->friction;
}

static void take_state(Body *body, const CuletState *state) {
  body->position = vec(state->position[0], state->position[1], state->position[2]);
  body->orientation =
      (Quat){state->orientation[0], state->orientation[1], state->orientation[2], state->orientation[3]};
  body->velocity = vec(state->velocity[0], state->velocity[1], state->velocity[2]);
  body->angular_momentum = vec(state->angular_momentum[0], state->angular_momentum[1], state->angular_momentum[2]);
  refresh(body);
}

static void forget_separating_axes(World *world) {
  memset(world->separating, 0, sizeof(Vec3) * (size_t)world->capacity * (size_t)world->capacity);
}

int32_t culet_world_add(CuletWorld *world, const CuletHull *hull, const CuletBody *given, const CuletState *state) {
  if (world->count == world->capacity) return -2;
  Body *body = &world->bodies[world->count];
  memset(body, 0, sizeof *body);
  int fault = hull_copy(&body->hull, hull);
  if (fault) return fault;
  body->size = body->hull.radius;
  body->asleep = state->asleep;
  body->held = state->held;
  body->bed = world->beds++;
  take_properties(body, given);
  take_state(body, state);
  forget_separating_axes(world);
  return world->count++;
}

static void forget_body(Contacts *contacts, int number) {
  int left = 0;
  for (int i = 0; i < contacts->manifold_count; i++) {
    Manifold manifold = contacts->manifolds[i];
    if (manifold.body == number || manifold.other == number) continue;
    manifold.body -= manifold.body > number;
    manifold.other -= manifold.other > number;
    contacts->manifolds[left++] = manifold;
  }
  contacts->manifold_count = left;
}

void culet_world_remove(CuletWorld *world, int32_t number) {
  culet_world_wake(world); /* what it carried falls */
  hull_free(&world->bodies[number].hull);
  memmove(&world->bodies[number], &world->bodies[number + 1], sizeof(Body) * (size_t)(world->count - number - 1));
  world->count--;
  forget_body(&world->now, number);
  forget_body(&world->before, number);
  forget_separating_axes(world);
}

void culet_world_set_body(CuletWorld *world, int32_t number, const CuletBody *given) {
  Body *body = &world->bodies[number];
  Vec3 spin = body->spin;
  take_properties(body, given);
  body->angular_momentum = angular_momentum_of(body, spin);
  refresh(body);
  culet_world_wake(world);
}

void culet_world_set_state(CuletWorld *world, int32_t number, const CuletState *state) {
  take_state(&world->bodies[number], state);
  culet_world_wake(world);
}

void culet_world_hold(CuletWorld *world, int32_t number, int32_t held) {
  Body *body = &world->bodies[number];
  culet_world_wake(world);
  body->held = held;
  if (held) body->velocity = body->angular_momentum = body->spin = ZERO;
}

void culet_world_push(CuletWorld *world, int32_t number, const double impulse[3], const double point[3]) {
  Body *body = &world->bodies[number];
  Vec3 blow = vec(impulse[0], impulse[1], impulse[2]);
  Vec3 arm = sub(vec(point[0], point[1], point[2]), body->position);
  wake_body(world, number);
  body->velocity = add(body->velocity, scaled(blow, 1 / body->mass));
  body->angular_momentum = add(body->angular_momentum, cross(arm, blow));
  refresh(body);
}

/* Bodies that cannot move have no inverse mass in this substep. */
static void weigh(World *world) {
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    int moves = !body->asleep && !body->held;
    body->inverse_mass = moves ? 1 / body->mass : 0;
    body->world_inverse_inertia = moves ? turned_tensor(&body->axes, &body->inverse_inertia) : (Mat3){ZERO, ZERO, ZERO};
  }
}

static int substeps_of(const World *world, double time) {
  double g = world->law.gravity, needed = world->law.substeps;
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    if (body->asleep || body->held) continue;
    double speed = length(body->velocity) + length(body->spin) * body->size + g * time;
    needed = larger(needed, speed * time / (REACH * body->hull.inradius));
    needed = larger(needed, time * sqrt(g / body->size) / world->law.contact_step);
  }
  return needed < MAX_SUBSTEPS ? (int)ceil(needed) : MAX_SUBSTEPS;
}

/* How much of the time two bodies may go on before they are so near that where they touch is known: conservative
 * advancement (Mirtich 1996, "Impulse-based dynamic simulation"). All of it for those that do not come nearer by as much
 * as they are thick, for which contacts ahead are exact enough, and for those that go apart along the axis that separates
 * them. */
static double until_near(World *world, const Body *a, const Body *b, double time) {
  double thick = a->hull.inradius + b->hull.inradius, reach = a->size + b->size;
  Vec3 velocity = sub(a->velocity, b->velocity), apart = sub(b->position, a->position);
  double speed = length(velocity);
  if ((speed + length(a->spin) * a->size + length(b->spin) * b->size) * time <= PACE * thick) return time;
  double turning = farthest_moved(a, a->spin) + farthest_moved(b, b->spin), way = (speed + turning) * time;
  if (speed + turning <= world->law.gravity * time) return time; /* it is gravity that moves them in this substep */
  if (way <= PACE * thick || length(apart) > reach + way) return time;
  Mat3 turn;
  Vec3 offset;
  pair_pose(a, b, &turn, &offset);
  Axis axis = separation(&a->hull, &b->hull, &turn, offset, way, 0, world->room);
  if (axis.distance > way) return time;
  double closing = dot(velocity, times(&a->axes, axis.normal)) + turning;
  if (closing <= 0) return time;
  double near = NEAR * smaller(a->hull.inradius, b->hull.inradius);
  if (axis.distance <= 2 * near) return smaller(time, PACE * thick / (speed + turning));
  return closing * time > axis.distance - near ? (axis.distance - near) / closing : time;
}

static double safe_part(World *world, double time) {
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    for (int k = i + 1; k < world->count; k++) {
      const Body *other = &world->bodies[k];
      if ((body->asleep || body->held) && (other->asleep || other->held)) continue;
      time = until_near(world, body, other, time);
    }
  }
  return time;
}

static int substep(World *world, double time) {
  if (find_contacts(world, time)) return -1;
  weigh(world);
  int bounces = bounces_of(world, time);
  kick(world, time);
  solve_impulses(world, time, 1, 1);
  if (bounces) limit_energy(world, time);
  move(world, time);
  push_apart(world);
  fall_asleep(world, time);
  return 0;
}

int32_t culet_world_step(CuletWorld *world, double time) {
  int awake = 0;
  for (int i = 0; i < world->count; i++) awake |= !world->bodies[i].asleep && !world->bodies[i].held;
  if (!awake) return 0;
  int count = substeps_of(world, time), further = MAX_FURTHER;
  double part = time / count;
  for (int i = 0; i < count; i++)
    for (double left = part; left > 0;) {
      double now = further > 0 ? safe_part(world, left) : left;
      if (now < left) further--;
      if (substep(world, now)) return -1;
      world->now_is_short = now < TELLING * part;
      left -= now;
    }
  return 0;
}

void culet_world_states(const CuletWorld *world, CuletState *states) {
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    Vec3 p = body->position, v = body->velocity, momentum = body->angular_momentum, spin = body->spin;
    Quat q = body->orientation;
    states[i] = (CuletState){
        {p.x, p.y, p.z},          {q.w, q.x, q.y, q.z}, {v.x, v.y, v.z}, {momentum.x, momentum.y, momentum.z},
        {spin.x, spin.y, spin.z}, body->asleep,         body->held};
  }
}

void culet_world_touches(const CuletWorld *world, CuletTouch *touches) {
  memset(touches, 0, sizeof(CuletTouch) * (size_t)world->count);
  for (int i = 0; i < world->now.manifold_count; i++) {
    const Manifold *manifold = &world->now.manifolds[i];
    for (int k = 0; k < manifold->count; k++) {
      double gap = world->now.contacts[manifold->first + k].gap;
      for (int side = 0; side < 2; side++) {
        int number = side ? manifold->other : manifold->body;
        if (number == NONE || gap > TOUCHING * world->bodies[number].size) continue;
        touches[number].contacts++;
        touches[number].penetration = larger(touches[number].penetration, -gap);
      }
    }
  }
}

double culet_world_separation(CuletWorld *world, int32_t one, int32_t other, double enough, double axis[3]) {
  const Body *a = &world->bodies[one], *b = &world->bodies[other];
  Mat3 turn;
  Vec3 offset;
  pair_pose(a, b, &turn, &offset);
  Axis best = separation(&a->hull, &b->hull, &turn, offset, enough, 0, world->room);
  Vec3 along = times(&a->axes, best.normal);
  axis[0] = along.x, axis[1] = along.y, axis[2] = along.z;
  return best.distance;
}
