/* No island gains kinetic energy by its impulses.
 *
 * Newton's restitution at several points with friction can create energy (Kane 1984). Where it does, the answer with
 * restitution, w1, is blended with the one without, w0, which no impulse of does positive work: all w0 + s (w1 - w0), 0
 * <= s <= 1, are impulses on their cones. The kinetic energy is a quadratic of s, so the largest s at which it is not
 * above what it was is known. */
#include "solver.h"

#define ROUNDING 1e-10 /* of an island's kinetic energy */

static double energy_between(const Body *body, Vec3 velocity, Vec3 spin, Vec3 other_velocity, Vec3 other_spin) {
  return body->mass * dot(velocity, other_velocity) + dot(spin, angular_momentum_of(body, other_spin));
}

double kinetic_energy(const Body *body) {
  return energy_between(body, body->velocity, body->spin, body->velocity, body->spin) / 2;
}

static double largest_part(const Course *course) {
  if (course->constant >= 0) return 0;
  if (!(course->square > 0)) return 1;
  double root = sqrt(larger(course->linear * course->linear - 4 * course->square * course->constant, 0));
  return smaller(larger((root - course->linear) / (2 * course->square), 0), 1);
}

void limit_energy(World *world, double time) {
  Contacts *now = &world->now;
  Course *courses = world->courses;
  separate_islands(world);
  for (int i = 0; i < now->count; i++) {
    const Contact *contact = &now->contacts[i];
    if (contact->other != NONE && contact->normal_impulse > 0 && world->bodies[contact->body].inverse_mass > 0 &&
        world->bodies[contact->other].inverse_mass > 0)
      join(world, contact->body, contact->other);
  }
  for (int i = 0; i < world->count; i++) {
    Course *course = &courses[i];
    course->gain = course->scale = course->square = course->linear = course->constant = 0;
    course->part = 1;
  }
  for (int i = 0; i < world->count; i++) {
    if (world->bodies[i].inverse_mass == 0) continue;
    Course *whole = &courses[island(world, i)];
    whole->gain += kinetic_energy(&world->bodies[i]) - courses[i].kinetic;
    whole->scale += courses[i].kinetic;
  }
  int gained = 0;
  for (int i = 0; i < world->count; i++) gained |= courses[i].gain > ROUNDING * courses[i].scale;
  if (!gained) return;

  for (int i = 0; i < now->count; i++) {
    now->contacts[i].kept_normal = now->contacts[i].normal_impulse;
    now->contacts[i].kept_slip = now->contacts[i].slip_impulse;
  }
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    courses[i].first_velocity = body->velocity;
    courses[i].first_spin = body->spin;
    body->velocity = courses[i].pushed_velocity;
    body->spin = courses[i].pushed_spin;
  }
  solve_impulses(world, time, 0, 0);
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    if (body->inverse_mass == 0) continue;
    Course *whole = &courses[island(world, i)];
    Vec3 velocity = sub(courses[i].first_velocity, body->velocity), spin = sub(courses[i].first_spin, body->spin);
    whole->square += energy_between(body, velocity, spin, velocity, spin) / 2;
    whole->linear += energy_between(body, body->velocity, body->spin, velocity, spin);
    whole->constant += kinetic_energy(body) - courses[i].kinetic;
  }
  for (int i = 0; i < world->count; i++)
    if (courses[i].gain > ROUNDING * courses[i].scale) courses[i].part = largest_part(&courses[i]);
  for (int i = 0; i < world->count; i++) {
    Body *body = &world->bodies[i];
    double part = courses[island(world, i)].part;
    body->velocity = add(body->velocity, scaled(sub(courses[i].first_velocity, body->velocity), part));
    body->spin = add(body->spin, scaled(sub(courses[i].first_spin, body->spin), part));
  }
  for (int i = 0; i < now->count; i++) {
    Contact *contact = &now->contacts[i];
    double part = courses[island(world, contact->body)].part;
    if (contact->other != NONE && world->bodies[contact->body].inverse_mass == 0)
      part = courses[island(world, contact->other)].part;
    contact->normal_impulse += part * (contact->kept_normal - contact->normal_impulse);
    contact->slip_impulse = add(contact->slip_impulse, scaled(sub(contact->kept_slip, contact->slip_impulse), part));
  }
}
