// What a scene is made of, as every stage sees it.
#ifndef CULET_WORLD
#define CULET_WORLD
#include "facet_rows.cl"
#include "mesh.cl"
#include "parameters.cl"
#include "record.cl"

// The buffers that make a scene, in the order in which they are the kernel's first arguments. This is the only list of them:
// the host passes them by these names (rendering/opencl/layout.py).
#define WORLD_BUFFERS(BUFFER)                                                                                          \
  BUFFER(__constant const parameters_t, scene)                                                                         \
  BUFFER(__constant const stone_t, stones)                                                                             \
  BUFFER(__constant const group_t, groups) /* MANY */                                                                  \
  BUFFER(__global const real, columns)     /* MANY: what differs by stone, see stone_columns.cl */                     \
  BUFFER(__global const real4, facets)     /* HULL: normal and offset */                                               \
  BUFFER(__global const real, blocks)      /* HULL of MANY: the same, by TREE_WIDTH */                                 \
  BUFFER(__global const real4, rows)       /* HULL: the same by symmetry, see facet_rows.cl */                         \
  BUFFER(__global const real4, shadows)    /* HULL: planes of the lights' shadow volumes */                            \
  BUFFER(__global const real, boxes)       /* MESH: see tree_t */                                                      \
  BUFFER(__global const int, links)                                                                                    \
  BUFFER(__global const real, corners)                                                                                 \
  BUFFER(__global const chain_t, chains)                                                                               \
  BUFFER(__global const float, panorama)  /* IMAGE: radiance by row from the zenith down, column and channel */        \
  BUFFER(__global const float, light_map) /* LIGHT_MAP: by surface, level, row, column and channel, see light_map.cl */

#define AS_MEMBER(type, name) type *name;
#define AS_ARGUMENT(type, name) type *name,
#define AS_VALUE(type, name) name,

typedef struct {
  WORLD_BUFFERS(AS_MEMBER)
#if RECORDED
  __global record_t *record;
  __global happening_t *events;
#endif
} world_t;

static inline tree_t tree_of(world_t world) {
  const tree_t tree = {world.boxes, world.links, world.corners};
  return tree;
}

#endif
