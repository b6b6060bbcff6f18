// What a scene is made of, as every stage sees it.
#ifndef CULET_WORLD
#define CULET_WORLD
#include "mesh.cl"
#include "parameters.cl"

typedef struct {
  __constant const parameters_t *scene;
  __global const real4 *facets;   // HULL: normal and offset, in the world's axes
  __global const real4 *shadows;  // HULL: planes of the lights' shadow volumes
  tree_t tree;                    // MESH
  __global const chain_t *chains;
  __global const float *panorama; // IMAGE: radiance by row from the zenith down, column and channel
} world_t;

#endif
