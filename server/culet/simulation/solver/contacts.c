/* All points that touch, or may touch within a substep, with the impulses that they had before. */
#include "solver.h"

#include <stdlib.h>
#include <string.h>

#define MOST_GROWTH 8 /* of an impulse from one substep to the next: a blow in a short one is no force that lasts */

int reserve_contacts(Contacts *contacts, int count, int manifold_count) {
  if (count > contacts->capacity) {
    int capacity = count > 2 * contacts->capacity ? count : 2 * contacts->capacity;
    Contact *grown = realloc(contacts->contacts, sizeof(Contact) * (size_t)capacity);
    if (!grown) return -1;
    contacts->contacts = grown;
    contacts->capacity = capacity;
  }
  if (manifold_count > contacts->manifold_capacity) {
    int capacity = manifold_count > 2 * contacts->manifold_capacity ? manifold_count : 2 * contacts->manifold_capacity;
    Manifold *grown = realloc(contacts->manifolds, sizeof(Manifold) * (size_t)capacity);
    if (!grown) return -1;
    contacts->manifolds = grown;
    contacts->manifold_capacity = capacity;
  }
  return 0;
}

/* Of `body` beside `other`, where they touch. */
Vec3 contact_velocity(const World *world, const Contact *contact) {
  const Body *body = &world->bodies[contact->body];
  Vec3 velocity = add(body->velocity, cross(body->spin, contact->arm));
  if (contact->other == NONE) return velocity;
  const Body *other = &world->bodies[contact->other];
  return sub(velocity, add(other->velocity, cross(other->spin, contact->other_arm)));
}

static Manifold *new_manifold(World *world, int body, int other, int surface) {
  Contacts *now = &world->now;
  if (reserve_contacts(now, 0, now->manifold_count + 1)) return NULL;
  Manifold *manifold = &now->manifolds[now->manifold_count++];
  double size = world->bodies[body].size;
  if (other != NONE) size = smaller(size, world->bodies[other].size);
  *manifold = (Manifold){body, other, surface, now->count, 0, world->law.rolling_resistance * size, 0, 0, ZERO};
  return manifold;
}

static int new_contact(World *world, Manifold *manifold, Vec3 normal, Vec3 point, double gap, uint64_t feature) {
  Contacts *now = &world->now;
  if (reserve_contacts(now, now->count + 1, 0)) return -1;
  Contact *contact = &now->contacts[now->count++];
  const Body *body = &world->bodies[manifold->body];
  memset(contact, 0, sizeof *contact);
  contact->body = manifold->body;
  contact->other = manifold->other;
  contact->normal = normal;
  contact->arm = sub(point, body->position);
  contact->gap = gap;
  contact->feature = feature;
  contact->restitution = body->restitution;
  contact->friction = body->friction;
  if (manifold->other != NONE) {
    const Body *other = &world->bodies[manifold->other];
    contact->other_arm = sub(point, other->position);
    contact->restitution = (body->restitution + other->restitution) / 2;
    contact->friction = sqrt(body->friction * other->friction);
  }
  manifold->count++;
  return 0;
}

/* How fast any point of a body can move within the time, R/s. */
static double fastest(const World *world, const Body *body, double time) {
  return length(body->velocity) + length(body->spin) * body->size + world->law.gravity * time;
}

static int surface_contacts(World *world, int number, double time) {
  const Body *body = &world->bodies[number];
  const Hull *hull = &body->hull;
  double margin = MARGIN * body->size + fastest(world, body, time) * time;
  for (int s = 0; s < world->surface_count; s++) {
    const Surface *surface = &world->surfaces[s];
    double height = dot(surface->normal, body->position) - surface->offset;
    if (height > hull->radius + margin) continue;
    Vec3 normal = transposed_times(&body->axes, surface->normal);
    if (height + hull_lowest(hull, normal, world->room->reaches) >= margin) continue;
    Manifold *manifold = new_manifold(world, number, NONE, s);
    if (!manifold) return -1;
    for (int i = 0; i < hull->vertex_count; i++) {
      double gap = height + world->room->reaches[i];
      if (gap >= margin) continue;
      Vec3 point = add(times(&body->axes, hull_vertex(hull, i)), body->position);
      if (new_contact(world, manifold, surface->normal, point, gap, (uint64_t)i)) return -1;
    }
  }
  return 0;
}

static int pair_contacts(World *world, int one, int other, double time) {
  const Body *a = &world->bodies[one], *b = &world->bodies[other];
  double margin = MARGIN * smaller(a->size, b->size) + (fastest(world, a, time) + fastest(world, b, time)) * time;
  Vec3 apart = sub(b->position, a->position);
  double reach = a->hull.radius + b->hull.radius + margin;
  if (dot(apart, apart) > reach * reach) return 0;
  Vec3 normal;
  int count = pair_points(world, one, other, margin, &normal);
  if (count == 0) return 0;
  Manifold *manifold = new_manifold(world, other, one, NONE);
  if (!manifold) return -1;
  for (int i = 0; i < count; i++) {
    const PairPoint *point = &world->room->points[i];
    if (new_contact(world, manifold, normal, point->point, point->gap, point->feature)) return -1;
  }
  return 0;
}

/* The order in which manifolds are found: by the lower number of the pair, its surfaces first. */
static int before(const Manifold *one, const Manifold *other) {
  int a = one->other == NONE ? one->body : one->other, b = other->other == NONE ? other->body : other->other;
  if (a != b) return a < b;
  if ((one->other == NONE) != (other->other == NONE)) return one->other == NONE;
  return one->other == NONE ? one->surface < other->surface : one->body < other->body;
}

static void take_over(Contact *contact, const Contact *same, double ratio) {
  double along = dot(same->slip_impulse, contact->normal);
  contact->normal_impulse = ratio * same->normal_impulse;
  contact->slip_impulse = scaled(sub(same->slip_impulse, scaled(contact->normal, along)), ratio);
}

static Contact *the_same(const Contacts *contacts, const Manifold *manifold, uint64_t feature) {
  for (int i = 0; i < manifold->count; i++) {
    Contact *contact = &contacts->contacts[manifold->first + i];
    if (contact->feature == feature) return contact;
  }
  return NULL;
}

/* Where two faces lie on each other, the points stay, but are corners now of the one face, now of the other, or of edges
 * that cross: what a point that is no more has carried goes to the nearest new one, if that is near. */
static void take_over_the_near(World *world, const Manifold *manifold, const Manifold *last, double ratio) {
  const Body *body = &world->bodies[manifold->body], *other = &world->bodies[manifold->other];
  double near = SAME * smaller(body->hull.inradius, other->hull.inradius);
  for (int q = 0; q < last->count; q++) {
    const Contact *gone = &world->before.contacts[last->first + q];
    if (gone->normal_impulse == 0 || the_same(&world->now, manifold, gone->feature)) continue;
    Contact *nearest = NULL;
    double least = near * near;
    for (int p = 0; p < manifold->count; p++) {
      Contact *contact = &world->now.contacts[manifold->first + p];
      Vec3 apart = sub(contact->arm, gone->arm);
      double squared = dot(apart, apart);
      if (squared >= least || contact->normal_impulse > 0 || the_same(&world->before, last, contact->feature)) continue;
      least = squared;
      nearest = contact;
    }
    if (nearest && dot(nearest->normal, gone->normal) > 0) take_over(nearest, gone, ratio);
  }
}

/* Contacts that were there in the last substep begin with its impulses: what carries a stone is as a force nearly the
 * same, and as an impulse in proportion to the length of the substep. */
static void take_over_impulses(World *world) {
  const Contacts *old = &world->before;
  Contacts *now = &world->now;
  double ratio = world->before_time > 0 ? smaller(world->now_time / world->before_time, MOST_GROWTH) : 1;
  int k = 0;
  for (int i = 0; i < now->manifold_count; i++) {
    Manifold *manifold = &now->manifolds[i];
    while (k < old->manifold_count && before(&old->manifolds[k], manifold)) k++;
    if (k == old->manifold_count || before(manifold, &old->manifolds[k])) continue;
    const Manifold *last = &old->manifolds[k];
    manifold->rolling_impulse = scaled(last->rolling_impulse, ratio);
    for (int p = 0; p < manifold->count; p++) {
      Contact *contact = &now->contacts[manifold->first + p];
      const Contact *same = the_same(old, last, contact->feature);
      if (same) take_over(contact, same, ratio);
    }
    if (manifold->other != NONE) take_over_the_near(world, manifold, last, ratio);
  }
}

static int collect(World *world, double time) {
  world->now.count = world->now.manifold_count = 0;
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    int still = body->asleep || body->held;
    if (!still && surface_contacts(world, i, time)) return -1;
    for (int k = i + 1; k < world->count; k++) {
      const Body *other = &world->bodies[k];
      if (still && (other->asleep || other->held)) continue;
      if (pair_contacts(world, i, k, time)) return -1;
    }
  }
  return 0;
}

/* With whose impulses the next substep begins. */
const Contacts *telling_contacts(const World *world) { return world->now_is_short ? &world->before : &world->now; }

/* 0, or -1 if there is no memory. Wakes sleepers that are touched: these have contacts of their own. */
int find_contacts(World *world, double time) {
  if (!world->now_is_short) {
    Contacts last = world->before;
    world->before = world->now;
    world->before_time = world->now_time;
    world->now = last;
  }
  world->now_time = time;
  do {
    if (collect(world, time)) return -1;
  } while (wake_touched(world));
  take_over_impulses(world);
  return 0;
}
