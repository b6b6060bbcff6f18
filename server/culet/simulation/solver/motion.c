/* What a substep does with its bodies: where they touch, the kick of gravity, and the way that they go.
 *
 * A body that bounces is moved up to the moment of touch with the velocity of before and from there on with the one
 * after, so that heights of bounces are exact; one that stays in contact is moved by the velocity after; one that flies
 * is on its parabola. */
#include "solver.h"

#define CORRECTION 0.5     /* of an overlap, in one substep */
#define SWEEPS 4           /* of pushing apart */
#define NEAR 1e-2          /* size: contacts farther apart take no part in it */
#define FARTHEST_PUSH 0.05 /* size, in one substep */
#define GAIN 1e-10         /* of m g size and of the energy of its spin, that a body may get by being turned apart */
#define HALVINGS 8         /* of a turn that would give it more */

static double falling(const World *world, const Contact *contact) {
  double acceleration = world->bodies[contact->body].inverse_mass > 0 ? -world->law.gravity : 0;
  if (contact->other != NONE && world->bodies[contact->other].inverse_mass > 0) acceleration += world->law.gravity;
  return acceleration * contact->normal.y;
}

static void note_touch(Course *course, double when) {
  if (course->touch < 0 || when < course->touch) course->touch = when;
}

/* Finds the contacts that bounce within the substep, and when: gap + v t + a t^2 / 2 = 0. Their arms become those at the
 * moment of touch. Whether there are any. */
int bounces_of(World *world, double time) {
  int any = 0;
  for (int i = 0; i < world->count; i++) world->courses[i].touch = -1;
  for (int i = 0; i < world->now.count; i++) {
    Contact *contact = &world->now.contacts[i];
    const Body *body = &world->bodies[contact->body];
    const Body *other = contact->other == NONE ? NULL : &world->bodies[contact->other];
    double velocity = dot(contact_velocity(world, contact), contact->normal);
    double acceleration = falling(world, contact);
    contact->bounces = 0;
    if (contact->restitution == 0 || velocity >= 0 ||
        contact->gap + velocity * time + acceleration * time * time / 2 > 0)
      continue;
    double when = 0;
    if (contact->gap > 0) {
      double root = sqrt(larger(velocity * velocity - 2 * acceleration * contact->gap, 0));
      when = smaller(2 * contact->gap / (root - velocity), time);
    }
    double size = other ? smaller(body->size, other->size) : body->size;
    double g = world->law.gravity, least = larger(world->law.bounce_speed * sqrt(g * size), g * time);
    if (velocity + acceleration * when >= -least) continue;
    contact->bounces = any = 1;
    if (other) {
      Vec3 turning = scaled(cross(other->spin, contact->other_arm), when);
      contact->other_arm = add(contact->other_arm, turning);
      contact->arm = add(contact->arm, add(scaled(sub(other->velocity, body->velocity), when), turning));
      note_touch(&world->courses[contact->other], when);
    } else
      contact->arm = add(contact->arm, scaled(cross(body->spin, contact->arm), when));
    note_touch(&world->courses[contact->body], when);
  }
  return any;
}

/* A body that bounces is moved up to its touch, with the velocity of before; gravity acts on it until then, and on all
 * others for the whole substep. */
static void kick_body(const World *world, Body *body, Course *course, double time) {
  double g = world->law.gravity, touch = course->touch;
  course->velocity = body->velocity;
  if (body->inverse_mass > 0 && touch >= 0) {
    body->position = add(body->position, scaled(body->velocity, touch));
    body->position.y -= g * touch * touch / 2;
    rotate_freely(body, touch);
  }
  if (body->inverse_mass > 0) body->velocity.y -= g * (touch >= 0 ? touch : time);
  course->pushed_velocity = body->velocity;
  course->pushed_spin = body->spin;
  course->kinetic = body->inverse_mass > 0 ? kinetic_energy(body) : 0;
}

void kick(World *world, double time) {
  for (int i = 0; i < world->count; i++) kick_body(world, &world->bodies[i], &world->courses[i], time);
  for (int i = 0; i < world->now.count; i++) {
    Contact *contact = &world->now.contacts[i];
    if (contact->bounces) contact->arrival = dot(contact_velocity(world, contact), contact->normal);
  }
}

static void move_body(const World *world, Body *body, const Course *course, double time) {
  double g = world->law.gravity, left = course->touch >= 0 ? time - course->touch : time;
  if (course->touched) body->angular_momentum = angular_momentum_of(body, body->spin);
  if (!course->touched && course->touch < 0) body->velocity = course->velocity;
  body->position = add(body->position, scaled(body->velocity, left));
  if (!course->touched || course->touch >= 0) { /* on a parabola; what stays in contact has had its gravity */
    body->position.y -= g * left * left / 2;
    body->velocity.y -= g * left;
  }
  rotate_freely(body, left);
}

void move(World *world, double time) {
  for (int i = 0; i < world->count; i++) world->courses[i].touched = 0;
  for (int i = 0; i < world->now.manifold_count; i++) {
    const Manifold *manifold = &world->now.manifolds[i];
    double pressing = 0;
    for (int k = 0; k < manifold->count; k++) pressing += world->now.contacts[manifold->first + k].normal_impulse;
    if (pressing == 0) continue;
    world->courses[manifold->body].touched = 1;
    if (manifold->other != NONE) world->courses[manifold->other].touched = 1;
  }
  for (int i = 0; i < world->count; i++)
    if (world->bodies[i].inverse_mass > 0) move_body(world, &world->bodies[i], &world->courses[i], time);
}

static void shift(World *world, int number, Vec3 arm, Vec3 push) {
  const Body *body = &world->bodies[number];
  Course *course = &world->courses[number];
  if (body->inverse_mass == 0) return;
  course->shift = add(course->shift, scaled(push, body->inverse_mass));
  course->turn = add(course->turn, times(&body->world_inverse_inertia, cross(arm, push)));
}

static Vec3 shift_at(const World *world, int number, Vec3 arm) {
  return add(world->courses[number].shift, cross(world->courses[number].turn, arm));
}

static double spin_energy(const Body *body) { return dot(body->spin, body->angular_momentum) / 2; }

/* Turned by d, a body that keeps its angular momentum L has another energy of spin: by d . (omega x L), since L is then
 * about other axes of the body. What of a turn would add energy is left out: the shift moves it apart as well. */
static void turn_without_gain(const World *world, Body *body, Vec3 half) {
  Quat before = body->orientation;
  double energy = spin_energy(body);
  double most = energy + GAIN * (energy + body->mass * world->law.gravity * body->size);
  Vec3 uphill = cross(body->spin, body->angular_momentum);
  Vec3 across = times(&body->world_inverse_inertia, uphill);
  double slope = dot(uphill, across);
  body->orientation = cayley(before, half);
  refresh(body);
  if (spin_energy(body) <= most) return;
  if (slope > 0) half = sub(half, scaled(across, dot(half, uphill) / slope));
  for (int i = 0; i < HALVINGS; i++) {
    body->orientation = cayley(before, half);
    refresh(body);
    if (spin_energy(body) <= most) return;
    half = scaled(half, 0.5);
  }
  body->orientation = before;
  refresh(body);
}

/* Moves apart what overlaps by more than SLOP, by shifts and turns that velocities know nothing of. */
void push_apart(World *world) {
  Contacts *now = &world->now;
  int any = 0;
  for (int i = 0; i < world->count; i++) world->courses[i].shift = world->courses[i].turn = ZERO;
  for (int i = 0; i < now->count; i++) {
    Contact *contact = &now->contacts[i];
    double size = world->bodies[contact->body].size;
    if (contact->other != NONE) size = smaller(size, world->bodies[contact->other].size);
    contact->push = 0;
    contact->target = contact->gap > NEAR * size ? -INFINITY : -(contact->gap + SLOP * size) * CORRECTION;
    any |= contact->target > 0;
  }
  if (!any) return;
  for (int sweep = 0; sweep < SWEEPS; sweep++)
    for (int i = 0; i < now->count; i++) {
      Contact *contact = &now->contacts[i];
      if (contact->target == -INFINITY) continue;
      Vec3 moved = shift_at(world, contact->body, contact->arm);
      if (contact->other != NONE) moved = sub(moved, shift_at(world, contact->other, contact->other_arm));
      double wanted = contact->push + contact->normal_mass * (contact->target - dot(moved, contact->normal));
      double change = larger(wanted, 0) - contact->push;
      if (change == 0) continue;
      contact->push += change;
      shift(world, contact->body, contact->arm, scaled(contact->normal, change));
      if (contact->other != NONE) shift(world, contact->other, contact->other_arm, scaled(contact->normal, -change));
    }
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    Course *course = &world->courses[i];
    if (body->inverse_mass == 0) continue;
    double way = length(course->shift), most = FARTHEST_PUSH * body->size;
    body->position = add(body->position, way > most ? scaled(course->shift, most / way) : course->shift);
    double turn = length(course->turn);
    if (turn == 0) continue;
    Vec3 half = scaled(course->turn, turn > FARTHEST_PUSH ? FARTHEST_PUSH / turn / 2 : 0.5);
    turn_without_gain(world, body, half);
  }
}
