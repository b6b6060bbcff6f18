// What a scene's quantities are: arguments, never compiled in. The host finds each field here by its name
// (rendering/opencl/layout.py). Positions are relative to the frame's origin, in the world's axes, in units of R. One stone of
// scale 1 has its centre there, so that its own measure is the frame's.
#ifndef CULET_PARAMETERS
#define CULET_PARAMETERS
#include "lanes.cl"

#define ROW_KINDS 5
#define MAX_LIGHTS 8
#define MAX_LAMPS 24
#define MAX_SURFACES 4 // the floor and three walls
#define MAX_STONES 64  // a power of 2
#define MAP_LEVELS 2   // of a light map
#define MAP_SIZE 512   // rows and columns of each level

typedef struct {
  double foot[3];        // the point of pixel (0, 0)'s ray that is abreast of the origin
  double foot_column[3]; // how it moves with each column of pixels,
  double foot_row[3];    // and with each row
  real direction[3], direction_column[3], direction_row[3]; // the same for the ray's direction, not normalised
  real reach;                                               // from the eye to the foot, in lengths of that direction
  real cutoff;                                              // weight below which a chain ends
  real panorama_scale;                                      // factor on the radiance of the sky's image
  real panorama_turn;                                       // of the sky's image about the vertical, in whole turns
  real origin[3];                                  // of the frame, in the world, from where checkers are counted
  real sky_bottom[3], sky_top[3];                  // radiance, by channel
  real lamp[MAX_LAMPS][3];                         // direction of a lamp in the sky, of unit length;
  real lamp_rim[MAX_LAMPS], lamp_slope[MAX_LAMPS]; // its edge: rim - slope (squared distance to it), from 0 to 1
  real lamp_radiance[MAX_LAMPS][3];                // by channel
  real box[MAX_LAMPS][3][3];       // soft boxes: the way to one, of unit length, the way across, and the way up;
  real box_edge[MAX_LAMPS][2];     // share across, and up: edge (way to it) - |way across|, from 0 to 1;
  real box_level[MAX_LAMPS][2];    // radiance at its middle, and its rise by the way up, in parts of box_radiance
  real box_radiance[MAX_LAMPS][3]; // by channel
  real head[3];                    // the way to the observer's head, of unit length; its edge is as a lamp's
  real head_rim, head_slope;
  real head_radiance[3];           // by channel
  real backdrop_centre[3], backdrop_edge[3];           // radiance, by channel
  real backdrop_focus[2];                              // column and row where it is the centre's
  real backdrop_scale[2];                              // from columns and rows to parts of the way to its edge
  real floor_colour[3];                                // STUDIO_FLOOR: radiance, by channel
  real floor_reflectance, floor_fade, floor_roughness; // of stones, per R of height, and the tilt at most
  real surface[MAX_SURFACES][4];   // inward normal and offset: the room is n.x >= offset; the floor comes first
  real sky_light[MAX_SURFACES][3]; // what the sky sends to a surface past no stone: the radiance of a white matte one
  real albedo[2][2][3]; // of the floor's odd and even cells, then of the walls': of the light that each shows
  real cells[2];        // per R, of the floor's checker and the walls'
  real map_centre[MAX_SURFACES][2]; // along and across a surface, in the frame
  real map_scale[MAP_LEVELS];       // 1 / half size of a level
  real even_light[3];               // STUDIO_FLOOR: part of its light that comes from all around,
  real map_gain[3];                 // and 1 / all its light
  real light[MAX_LIGHTS][3];        // position
  real light_colour[MAX_LIGHTS][3]; // by channel
  real least_shade;                 // part of the floor's light below which a stone's contact shadow is none
  int stones, groups;
  int lights, lamps, boxes;
  int max_bounces;           // interior segments of a chain, at most
  int width, height;
  int chains;                // one for each index of refraction
  int panorama_width, panorama_height;
  int sample;                // its number, from which chance and the pixels' wavelengths are drawn
  int floor_kind, walls_kind, sky_kind, fresnel_kind, end_kind;
  int camera_inside;         // a stone,
  int camera_stone;          // this one
  int has_head, has_backdrop, glare;
  int has_map, floor_mapped; // light_map is there, of the floor too,
  int mapped_surface;        // and of this surface at least
  int pierces;               // a stone reaches through a surface of the room, which may hide a part of it
} parameters_t;

// A stone. Its facets, triangles and shadows are in its own measure: relative to its centre, in units of its radius. They are in the
// world's axes; but triangles in its own; and of MANY its facets in the inner axes, where they are those of all stones of its shape.
typedef struct {
  real centre[3];                    // in the frame
  real radius, inverse_radius;       // R
  real reach;                        // R from the centre within which a ray may meet it, rounded up
  real axes[3][3];                   // columns: its own axes in the world's, and
  real inner_axes[3][3];             // those in which light inside it is followed, see facet_rows.cl
  real absorption[3];                // per radius, by channel
  real contact[3][3];                // its contact shadow's ellipsoid, see room.cl
  real contact_shadow;               // part of the floor's light that it takes at most
  real shade_reach;                  // R from the centre within which it takes any
  int first_facet, facets;           // its half-spaces
  int first_block, blocks;           // the same, TREE_WIDTH abreast
  int first_row, row_end[ROW_KINDS]; // the same by symmetry, in the inner axes, see facet_rows.cl
  int root;                          // of its tree
  int first_chain;                   // its material's
  int convex;                        // light that leaves it does not come back by itself
  int by_triangles;                  // it is met by its tree, not by its half-spaces
  int alike;                         // the first stone of its shape, whose packets it shares; by_triangles: itself
  int few_mirrors;                   // it reflects light into few directions
  real apart[3];                     // R from the centre of its group,
  real power;                        // R^2, the square of that less the square of its reach: see near_stones
  int columns[2], rows[2];           // first and last pixel where a ray of the camera may meet it
  int shadow_start[MAX_LIGHTS + 1];  // where each light's planes begin
} stone_t;

// What differs by stone, where the lanes of a packet are in different ones (stone_columns.cl): columns of MAX_STONES numbers, by
// stone. Those of the chains follow, two for each chain of a stone: its eta and its absorption.
#define COLUMN_CENTRE 0
#define COLUMN_RADIUS 3
#define COLUMN_INVERSE_RADIUS 4
#define COLUMN_ALIKE 5
#define COLUMN_INNER_AXES 6 // row by row
#define COLUMN_ABSORPTION 15
#define COLUMNS 18
#define CHAIN_COLUMNS 2

// Stones that are near each other, at most eight: a ray that passes their common sphere by need not be tested against each.
typedef struct {
  real centre[3], reach;
  real shade_reach;
  int first, last; // stones: first <= number < last
} group_t;

// One index of refraction. Of a spectral scene the groups of pixels take them by turns.
typedef struct {
  real eta;
  real absorption;   // per R
  real share[3];     // of each channel's light; they sum to 1 over the chains that a pixel sees
  real summed_share; // without their signs
} chain_t;

// Photons of one emitter, from one place or one direction, at one stone: spread evenly over the circle that holds the stone as the
// emitter sees it.
typedef struct {
  real axis[3];      // the way of its light to the middle of the stone, of unit length
  real across[2][3]; // two directions at right angles to it, and to each other
  real distance;     // R from a point light to the middle of the stone; 0: light from infinity
  real spread;       // of a point light: 1 - cosine of half the angle that the circle fills there
  real radius;       // R of the circle
  real centre[3];    // of the stone, in the frame
  real flux[3];      // of each photon, by channel: R^2 times irradiance over pi
  real growth;       // of a point light: 1 over the squared distance where its irradiance is what its colour says
  real shift[2];     // of the sequence over the circle
  int stone;
} bundle_t;

// Where the light maps of the room's surfaces lie: along each surface, and across it.
typedef struct {
  real along[MAX_SURFACES][3], across[MAX_SURFACES][3];
  real centre[MAX_SURFACES][2]; // of the maps, in the frame
  real half_size[2];            // of each level, R
  int held;                     // surfaces that have maps, from the first on
} map_frame_t;

#endif
