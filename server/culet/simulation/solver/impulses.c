/* The impulses of all contacts together: none goes on inwards, and Coulomb's friction opposes slip.
 *
 * For each contact, with velocity v after the impulses, its normal part v_n and tangential part v_t, impulse p likewise:
 *
 *     v_n >= target,  p_n >= 0,  p_n (v_n - target) = 0         Signorini; target = -e v_n before, or -gap / h
 *     |p_t| <= mu p_n,  v_t = 0 or p_t = -mu p_n v_t / |v_t|    Coulomb, a disc: no direction is preferred
 *
 * by projected Gauss-Seidel from the impulses of the last substep (Moreau 1988, Jean 1999). Rolling resistance is a
 * moment against the turning of at most a lever arm times what presses; at small speeds it is proportional to the speed,
 * or it would hold a stone beside a facet on an edge. */
#include "solver.h"

#define TOLERANCE 1e-7     /* sqrt(g R): a sweep that changes no velocity by more is the last */
#define ROLLING_SPEED 0.05 /* sqrt(g / size): slower turning is resisted in proportion to its speed */

static void apply_normal(World *world, const Contact *contact, double impulse) {
  Body *body = &world->bodies[contact->body];
  body->velocity = add(body->velocity, scaled(contact->normal, impulse * body->inverse_mass));
  body->spin = add(body->spin, scaled(contact->turning, impulse));
  if (contact->other == NONE) return;
  Body *other = &world->bodies[contact->other];
  other->velocity = sub(other->velocity, scaled(contact->normal, impulse * other->inverse_mass));
  other->spin = sub(other->spin, scaled(contact->other_turning, impulse));
}

static void apply(World *world, const Contact *contact, Vec3 impulse) {
  Body *body = &world->bodies[contact->body];
  body->velocity = add(body->velocity, scaled(impulse, body->inverse_mass));
  body->spin = add(body->spin, times(&body->world_inverse_inertia, cross(contact->arm, impulse)));
  if (contact->other == NONE) return;
  Body *other = &world->bodies[contact->other];
  other->velocity = sub(other->velocity, scaled(impulse, other->inverse_mass));
  other->spin = sub(other->spin, times(&other->world_inverse_inertia, cross(contact->other_arm, impulse)));
}

static void apply_moment(World *world, const Manifold *manifold, Vec3 moment) {
  Body *body = &world->bodies[manifold->body];
  body->spin = add(body->spin, times(&body->world_inverse_inertia, moment));
  if (manifold->other == NONE) return;
  Body *other = &world->bodies[manifold->other];
  other->spin = sub(other->spin, times(&other->world_inverse_inertia, moment));
}

/* What an impulse along a direction does to the relative velocity at the contact. */
static Vec3 response(const World *world, const Contact *contact, Vec3 direction) {
  const Body *body = &world->bodies[contact->body];
  Vec3 change = scaled(direction, body->inverse_mass);
  change = add(change, cross(times(&body->world_inverse_inertia, cross(contact->arm, direction)), contact->arm));
  if (contact->other == NONE) return change;
  const Body *other = &world->bodies[contact->other];
  change = add(change, scaled(direction, other->inverse_mass));
  Vec3 turning = times(&other->world_inverse_inertia, cross(contact->other_arm, direction));
  return add(change, cross(turning, contact->other_arm));
}

static void prepare_contact(World *world, Contact *contact) {
  const Body *body = &world->bodies[contact->body];
  Vec3 normal = contact->normal;
  contact->turning = times(&body->world_inverse_inertia, cross(contact->arm, normal));
  if (contact->other != NONE) {
    const Body *other = &world->bodies[contact->other];
    contact->other_turning = times(&other->world_inverse_inertia, cross(contact->other_arm, normal));
  }
  contact->normal_mass = 1 / dot(normal, response(world, contact, normal));
  Vec3 s = cross(normal, fabs(normal.x) < 0.6 ? vec(1, 0, 0) : vec(0, 1, 0));
  s = scaled(s, 1 / length(s));
  Vec3 t = cross(normal, s), along_s = response(world, contact, s), along_t = response(world, contact, t);
  /* the larger eigenvalue across the normal: a step against slip of its inverse never overshoots */
  double ss = dot(s, along_s), tt = dot(t, along_t), st = dot(s, along_t), half = (ss - tt) / 2;
  contact->slip_mass = 1 / ((ss + tt) / 2 + sqrt(half * half + st * st));
}

static void prepare_manifold(World *world, Manifold *manifold, int warm) {
  const Contact *contacts = &world->now.contacts[manifold->first];
  const Mat3 *turning = &world->bodies[manifold->body].world_inverse_inertia;
  double trace = turning->a.x + turning->b.y + turning->c.z, size = world->bodies[manifold->body].size;
  Vec3 spin = world->bodies[manifold->body].spin;
  if (manifold->other != NONE) {
    const Body *other = &world->bodies[manifold->other];
    turning = &other->world_inverse_inertia;
    trace += turning->a.x + turning->b.y + turning->c.z;
    spin = sub(spin, other->spin);
    size = smaller(size, other->size);
  }
  double pressing = 0;
  int bounces = 0;
  for (int k = 0; k < manifold->count; k++) {
    pressing += contacts[k].normal_impulse;
    bounces |= contacts[k].bounces;
  }
  manifold->rolling_mass = 1 / trace;
  double slow = ROLLING_SPEED * sqrt(world->law.gravity / size);
  double turns = length(spin);
  manifold->rolling_part = bounces ? 0 : turns < slow ? turns / slow : 1;
  double limit = manifold->rolling * manifold->rolling_part * pressing, moment = length(manifold->rolling_impulse);
  if (!warm || limit <= 0)
    manifold->rolling_impulse = ZERO;
  else if (moment > limit)
    manifold->rolling_impulse = scaled(manifold->rolling_impulse, limit / moment);
}

/* The largest change of a normal velocity. */
static double sweep_manifold(World *world, Manifold *manifold) {
  Contact *contacts = &world->now.contacts[manifold->first];
  double pressing = 0, worst = 0;
  for (int k = 0; k < manifold->count; k++) {
    Contact *contact = &contacts[k];
    double before = contact->normal_impulse;
    double leaving = dot(contact_velocity(world, contact), contact->normal);
    if (before == 0 && leaving >= contact->target) continue; /* not pressed before, and not now */
    double after = larger(before + contact->normal_mass * (contact->target - leaving), 0);
    double change = after - before;
    contact->normal_impulse = after;
    if (change != 0) apply_normal(world, contact, change);
    if (contact->friction > 0) {
      Vec3 velocity = contact_velocity(world, contact);
      Vec3 slip = sub(velocity, scaled(contact->normal, dot(velocity, contact->normal)));
      Vec3 impulse = sub(contact->slip_impulse, scaled(slip, contact->slip_mass));
      double size = length(impulse), limit = contact->friction * after;
      if (size > limit) impulse = scaled(impulse, limit / size);
      apply(world, contact, sub(impulse, contact->slip_impulse));
      contact->slip_impulse = impulse;
    }
    pressing += after;
    worst = larger(worst, fabs(change) / contact->normal_mass);
  }
  double limit = manifold->rolling * manifold->rolling_part * pressing;
  if (limit > 0 || dot(manifold->rolling_impulse, manifold->rolling_impulse) > 0) {
    Vec3 spin = world->bodies[manifold->body].spin, normal = contacts[0].normal;
    if (manifold->other != NONE) spin = sub(spin, world->bodies[manifold->other].spin);
    Vec3 rolling = sub(spin, scaled(normal, dot(spin, normal))); /* about the normal it would be drilling */
    Vec3 moment = sub(manifold->rolling_impulse, scaled(rolling, manifold->rolling_mass));
    double size = length(moment);
    if (size > limit) moment = scaled(moment, limit / size);
    apply_moment(world, manifold, sub(moment, manifold->rolling_impulse));
    manifold->rolling_impulse = moment;
  }
  return worst;
}

/* `warm`: from the impulses that the contacts have, else from none. `bouncing`: with restitution. */
void solve_impulses(World *world, double time, int warm, int bouncing) {
  Contacts *now = &world->now;
  for (int i = 0; i < now->count; i++) {
    Contact *contact = &now->contacts[i];
    prepare_contact(world, contact);
    if (contact->bounces)
      contact->target = bouncing ? -contact->restitution * contact->arrival : 0;
    else
      contact->target = contact->gap > 0 ? -contact->gap / time : 0;
    if (!warm) {
      contact->normal_impulse = 0;
      contact->slip_impulse = ZERO;
    }
  }
  for (int i = 0; i < now->manifold_count; i++) prepare_manifold(world, &now->manifolds[i], warm);
  if (warm) {
    for (int i = 0; i < now->manifold_count; i++)
      if (dot(now->manifolds[i].rolling_impulse, now->manifolds[i].rolling_impulse) > 0)
        apply_moment(world, &now->manifolds[i], now->manifolds[i].rolling_impulse);
    for (int i = 0; i < now->count; i++) {
      const Contact *contact = &now->contacts[i];
      if (contact->normal_impulse > 0)
        apply(world, contact, add(scaled(contact->normal, contact->normal_impulse), contact->slip_impulse));
    }
  }
  double tolerance = TOLERANCE * sqrt(world->law.gravity);
  for (int sweep = 0; sweep < world->law.sweeps; sweep++) {
    double worst = 0;
    for (int i = 0; i < now->manifold_count; i++) worst = larger(worst, sweep_manifold(world, &now->manifolds[i]));
    if (worst < tolerance || worst == 0) break;
  }
}
