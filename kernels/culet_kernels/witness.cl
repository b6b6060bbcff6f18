// Who writes events down where a single ray is followed, which takes a packet of one lane. Other programs have none of it.
#ifndef CULET_WITNESS
#define CULET_WITNESS
#include "stones.cl"
#include "task.cl"

#if RECORDED
// Appends an event; returns its number.
static inline int append_event(world_t world, happening_t event) {
  const int number = world.record->count++;
  if (number >= world.record->most) return UNTOLD;
  world.events[number] = event;
  return number;
}

static inline happening_t event_of(int kind, int parent) {
  happening_t event = {.kind = kind, .parent = parent, .stone = NOBODY, .chain = -1, .surface = -1};
  return event;
}

static inline void set_place(happening_t *event, vec3L point, vec3L direction, vec3L normal) {
  event->point[0] = point.x, event->point[1] = point.y, event->point[2] = point.z;
  event->direction[0] = direction.x, event->direction[1] = direction.y, event->direction[2] = direction.z;
  event->normal[0] = normal.x, event->normal[1] = normal.y, event->normal[2] = normal.z;
}

// What happens to a packet's ray, at a place of the frame.
static inline happening_t event_of_packet(world_t world, task_t task, const packetL *packet, int kind) {
  happening_t event = event_of(kind, packet->event);
  event.chain = (int)(task.chains - world.chains) + (packet->tag >> PIXEL_BITS & (GROUPS - 1));
  event.stone = STONES == MANY ? packet->stone : 0;
  event.weight[0] = event.weight[1] = packet->weight[0];
  event.polarisation[0] = packet->polarisation.q;
  event.polarisation[1] = packet->polarisation.u;
  event.polarisation[2] = packet->polarisation.v;
  return event;
}

// Where a packet is in the frame.
static inline vec3L told_point(world_t world, const packetL *packet, int place) {
  if (!at_stone(place)) return packet->origin;
#if STONES == MANY
  return to_frame(world, packet->stone, outward_of(world, packet, packet->origin));
#else
  return outward(world.stones, packet->origin);
#endif
}
static inline vec3L told_direction(world_t world, const packetL *packet, int place, vec3L direction) {
  return at_stone(place) ? outward_of(world, packet, direction) : direction;
}

// Light that meets a stone from outside.
static inline int tell_entry(world_t world, task_t task, const packetL *packet, vec3L normal, real kept, int glare) {
  happening_t event = event_of_packet(world, task, packet, ENTERS);
  set_place(&event, told_point(world, packet, ENTERING), told_direction(world, packet, ENTERING, packet->direction),
            told_direction(world, packet, ENTERING, normal));
  event.kept = kept;
  event.surface = glare; // whether what is reflected is followed
  return append_event(world, event);
}

// Light that meets a stone's surface from inside, after a way there.
static inline int tell_meeting(world_t world, task_t task, const packetL *packet, real weight, real length,
                               vec3L normal) {
  happening_t event = event_of_packet(world, task, packet, MEETS);
  event.weight[0] = weight;
  event.length = length * world.stones[event.stone].radius;
  event.kept = 1;
  set_place(&event, told_point(world, packet, INSIDE), outward_of(world, packet, packet->direction),
            outward_of(world, packet, normal));
  return append_event(world, event);
}

static inline void tell_kept(world_t world, int number, real kept) {
  if (number >= 0) world.events[number].kept = kept;
}

// Weight that is dropped, and what is shown in its place.
static inline void tell_end(world_t world, task_t task, const packetL *packet, int place, radianceL seen) {
  happening_t event = event_of_packet(world, task, packet, ENDS);
  event.inside = place == INSIDE;
  event.cut = over_channels(task, packet);
  const vec3L direction = told_direction(world, packet, place, packet->direction);
  set_place(&event, told_point(world, packet, place), direction, direction);
  for (int k = 0; k < CHANNELS; k++) {
    const real light = packet->weight[min(k, WEIGHTS - 1)] * seen.channel[k];
    event.light[task.first_channel + k] = SPECTRAL ? OF_CHAIN(task, packet->tag, share[k]) * light : light;
  }
  append_event(world, event);
}

// A faint chain that goes on with more weight.
static inline int tell_chance(world_t world, task_t task, const packetL *packet, int inside, real factor) {
  happening_t event = event_of_packet(world, task, packet, CHANCE);
  event.inside = inside;
  event.kept = factor;
  event.weight[0] /= fmax(factor, (real)1e-30);
  return append_event(world, event);
}

// What was written down of a ray outside as if its weight were 1, from this number on, is a packet's. Its radiance is by the
// task's channels.
static inline void weigh_events(world_t world, int first, task_t task, const packetL *packet) {
  for (int number = first; number < min(world.record->count, world.record->most); number++) {
    __global happening_t *event = world.events + number;
    real light[3] = {0, 0, 0};
    for (int k = 0; k < CHANNELS; k++) {
      const real own = packet->weight[min(k, WEIGHTS - 1)] * event->light[k];
      light[task.first_channel + k] = SPECTRAL ? OF_CHAIN(task, packet->tag, share[k]) * own : own;
    }
    for (int k = 0; k < 3; k++) event->light[k] = light[k];
    event->cut *= over_channels(task, packet);
    event->weight[0] *= packet->weight[0];
    event->weight[1] *= packet->weight[0];
    const happening_t of_packet = event_of_packet(world, task, packet, SEES);
    event->chain = of_packet.chain;
    for (int k = 0; k < 3; k++) event->polarisation[k] = of_packet.polarisation[k];
  }
}

// Weight and light of what was written down from this number on, times a factor.
static inline void scale_events(world_t world, int first, real factor) {
  for (int number = first; number < min(world.record->count, world.record->most); number++)
    for (int k = 0; k < 3; k++) world.events[number].light[k] *= factor;
}
#endif

#endif
