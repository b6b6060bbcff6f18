/* A world as bytes, from which it goes on to the same bits: poses, momenta, timers of sleep, and the impulses with which
 * the next substep begins. What is computed anew from these (spins, matrices, separating axes) is left out. */
#include "solver.h"

#include <string.h>

#define MOST_BEDS (INT32_MAX / 2) /* as many stones can still fall asleep, one each second for 34 years */

typedef struct {
  int32_t version, bodies, surfaces, beds, manifolds, contacts;
  double time; /* s, the length of the substep that the impulses are of */
} Header;

typedef struct {
  double position[3], orientation[4], velocity[3], angular_momentum[3], still, fixed;
  double fixed_position[3], fixed_orientation[4];
  int32_t asleep, held, bed, unused;
} SavedBody;

typedef struct {
  int32_t body, other, surface, count;
  double rolling_impulse[3];
} SavedManifold;

typedef struct {
  uint64_t feature;
  double normal_impulse, slip_impulse[3], normal[3], arm[3];
} SavedContact;

static int contact_count(const Contacts *contacts) {
  int count = 0;
  for (int i = 0; i < contacts->manifold_count; i++) count += contacts->manifolds[i].count;
  return count;
}

static size_t size_of(int bodies, int manifolds, int contacts) {
  return sizeof(Header) + sizeof(SavedBody) * (size_t)bodies + sizeof(SavedManifold) * (size_t)manifolds +
         sizeof(SavedContact) * (size_t)contacts;
}

size_t culet_world_size(const CuletWorld *world) {
  const Contacts *last = telling_contacts(world);
  return size_of(world->count, last->manifold_count, contact_count(last));
}

static char *put(char *at, const void *record, size_t size) {
  memcpy(at, record, size);
  return at + size;
}

static const char *take(const char *at, void *record, size_t size) {
  memcpy(record, at, size);
  return at + size;
}

void culet_world_save(const CuletWorld *world, void *bytes) {
  const Contacts *last = telling_contacts(world);
  char *at = bytes;
  Header header = {CULET_INTERFACE,
                   world->count,
                   world->surface_count,
                   world->beds,
                   last->manifold_count,
                   contact_count(last),
                   world->now_is_short ? world->before_time : world->now_time};
  at = put(at, &header, sizeof header);
  for (int i = 0; i < world->count; i++) {
    const Body *body = &world->bodies[i];
    Vec3 p = body->position, v = body->velocity, momentum = body->angular_momentum;
    Vec3 there = body->fixed_position;
    Quat q = body->orientation, turned = body->fixed_orientation;
    SavedBody saved = {{p.x, p.y, p.z},
                       {q.w, q.x, q.y, q.z},
                       {v.x, v.y, v.z},
                       {momentum.x, momentum.y, momentum.z},
                       body->still,
                       body->fixed,
                       {there.x, there.y, there.z},
                       {turned.w, turned.x, turned.y, turned.z},
                       body->asleep,
                       body->held,
                       body->bed,
                       0};
    at = put(at, &saved, sizeof saved);
  }
  for (int i = 0; i < last->manifold_count; i++) {
    const Manifold *manifold = &last->manifolds[i];
    Vec3 r = manifold->rolling_impulse;
    SavedManifold saved = {manifold->body, manifold->other, manifold->surface, manifold->count, {r.x, r.y, r.z}};
    at = put(at, &saved, sizeof saved);
    for (int k = 0; k < manifold->count; k++) {
      const Contact *contact = &last->contacts[manifold->first + k];
      Vec3 s = contact->slip_impulse, n = contact->normal, arm = contact->arm;
      SavedContact point = {
          contact->feature, contact->normal_impulse, {s.x, s.y, s.z}, {n.x, n.y, n.z}, {arm.x, arm.y, arm.z}};
      at = put(at, &point, sizeof point);
    }
  }
}

/* No scene reaches 1e30, and the square of what 1e30 leads to is still a double. */
static int usable(const double *numbers, int count) {
  for (int i = 0; i < count; i++)
    if (!(fabs(numbers[i]) <= 1e30)) return 0;
  return 1;
}

static int sound_body(const SavedBody *body, const Header *header) {
  const double *q = body->orientation;
  double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return usable(body->position, 3) && fabs(norm - 1) < 1e-9 && usable(body->velocity, 3) &&
         usable(body->angular_momentum, 3) && usable(&body->still, 1) && body->still >= 0 && usable(&body->fixed, 1) &&
         body->fixed >= 0 && usable(body->fixed_position, 3) && usable(body->fixed_orientation, 4) &&
         (body->asleep & ~1) == 0 && (body->held & ~1) == 0 && body->bed >= 0 && body->bed < header->beds;
}

static int sound_manifold(const SavedManifold *manifold, const Header *header) {
  int of_surface = manifold->other == NONE && manifold->surface >= 0 && manifold->surface < header->surfaces;
  int of_pair = manifold->other >= 0 && manifold->other < manifold->body && manifold->surface == NONE;
  return manifold->body >= 0 && manifold->body < header->bodies && manifold->count > 0 && (of_surface || of_pair) &&
         usable(manifold->rolling_impulse, 3);
}

/* Whether the bytes are a snapshot of a world with so many bodies and surfaces. */
static int sound(const World *world, const Header *header, const char *bytes, size_t size) {
  if (header->version != CULET_INTERFACE || header->bodies != world->count ||
      header->surfaces != world->surface_count || !usable(&header->time, 1) || header->time < 0 || header->beds < 0 ||
      header->beds > MOST_BEDS || header->manifolds < 0 || header->contacts < 0 ||
      (size_t)header->manifolds > size / sizeof(SavedManifold) ||
      (size_t)header->contacts > size / sizeof(SavedContact) ||
      size != size_of(header->bodies, header->manifolds, header->contacts))
    return 0;
  const char *at = bytes + sizeof *header;
  for (int i = 0; i < header->bodies; i++) {
    SavedBody body;
    at = take(at, &body, sizeof body);
    if (!sound_body(&body, header)) return 0;
  }
  int left = header->contacts;
  for (int i = 0; i < header->manifolds; i++) {
    SavedManifold manifold;
    at = take(at, &manifold, sizeof manifold);
    if (!sound_manifold(&manifold, header) || manifold.count > left) return 0;
    left -= manifold.count;
    for (int k = 0; k < manifold.count; k++) {
      SavedContact contact;
      at = take(at, &contact, sizeof contact);
      if (!usable(&contact.normal_impulse, 1) || contact.normal_impulse < 0 || !usable(contact.slip_impulse, 3) ||
          !usable(contact.normal, 3) || !usable(contact.arm, 3))
        return 0;
    }
  }
  return left == 0;
}

int32_t culet_world_load(CuletWorld *world, const void *bytes, size_t size) {
  Header header;
  if (size < sizeof header) return -1;
  const char *at = take(bytes, &header, sizeof header);
  if (!sound(world, &header, bytes, size)) return -1;
  if (reserve_contacts(&world->now, header.contacts, header.manifolds)) return -2;
  world->beds = header.beds;
  world->now_time = header.time;
  world->now_is_short = 0;
  for (int i = 0; i < header.bodies; i++) {
    SavedBody saved;
    at = take(at, &saved, sizeof saved);
    Body *body = &world->bodies[i];
    const double *p = saved.position, *q = saved.orientation, *v = saved.velocity, *l = saved.angular_momentum;
    const double *there = saved.fixed_position, *turned = saved.fixed_orientation;
    body->position = vec(p[0], p[1], p[2]);
    body->orientation = (Quat){q[0], q[1], q[2], q[3]};
    body->velocity = vec(v[0], v[1], v[2]);
    body->angular_momentum = vec(l[0], l[1], l[2]);
    body->still = saved.still;
    body->fixed = saved.fixed;
    body->fixed_position = vec(there[0], there[1], there[2]);
    body->fixed_orientation = (Quat){turned[0], turned[1], turned[2], turned[3]};
    body->asleep = saved.asleep;
    body->held = saved.held;
    body->bed = saved.bed;
    refresh(body);
  }
  Contacts *now = &world->now;
  now->count = now->manifold_count = 0;
  for (int i = 0; i < header.manifolds; i++) {
    SavedManifold saved;
    at = take(at, &saved, sizeof saved);
    const double *r = saved.rolling_impulse;
    Manifold *manifold = &now->manifolds[now->manifold_count++];
    *manifold =
        (Manifold){saved.body, saved.other, saved.surface, now->count, saved.count, 0, 0, 0, {r[0], r[1], r[2]}};
    for (int k = 0; k < saved.count; k++) {
      SavedContact point;
      at = take(at, &point, sizeof point);
      Contact *contact = &now->contacts[now->count++];
      memset(contact, 0, sizeof *contact);
      const double *s = point.slip_impulse, *n = point.normal, *arm = point.arm;
      contact->feature = point.feature;
      contact->normal_impulse = point.normal_impulse;
      contact->slip_impulse = vec(s[0], s[1], s[2]);
      contact->normal = vec(n[0], n[1], n[2]);
      contact->arm = vec(arm[0], arm[1], arm[2]);
      contact->body = saved.body;
      contact->other = saved.other;
      contact->gap = INFINITY; /* until the next substep finds it */
    }
  }
  return 0;
}
