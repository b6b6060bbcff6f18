// What a program contains. Each feature is one -D with a kind of scene as its value; RUNTIME, the default, leaves the
// choice to the parameters, so a program without any -D renders every scene. A fixed value folds the choice away at
// compile time: the code of the other kinds is not in the program. No other file looks at a feature except through the
// macros at the end of this one.
#ifndef CULET_FEATURES
#define CULET_FEATURES
#include "lanes.cl"

#define RUNTIME (-1)

// Kinds of ESTIMATOR.
#define CHAIN 0
#define CLASSIC 1

// Kinds of surface for FLOOR and WALLS; of STUDIO_FLOOR are floors only.
#define NONE 0
#define MATTE 1
#define MIRROR 2
#define STUDIO_FLOOR 3

// Kinds of SKY.
#define CONSTANT 0
#define GRADIENT 1
#define HALF 2
#define IMAGE 3

// Kinds of GEOMETRY: no stone, facet half-spaces, or triangles in a tree; of MANY stones MESH has both. Never RUNTIME.
#define EMPTY 0
#define HULL 1
#define MESH 2

// Kinds of STONES: one of scale 1, at the origin of the frame; or a table of them. Never RUNTIME.
#define ONE 1
#define MANY 2

// Kinds of FRESNEL.
#define EXACT 0
#define SCHLICK 1

// Kinds of END, where a chain's weight falls below the cut-off: it is dropped; or goes on by chance, with more weight,
// which is right on average; or sees the sky in the mirrored direction, as in the report.
#define CUT 0
#define ROULETTE 1
#define SKYLIGHT 2

#ifndef ESTIMATOR // never RUNTIME
#define ESTIMATOR CHAIN
#endif
#ifndef GEOMETRY
#define GEOMETRY HULL
#endif
#ifndef STONES
#define STONES ONE
#endif
#ifndef FLOOR
#define FLOOR RUNTIME
#endif
#ifndef WALLS
#define WALLS RUNTIME
#endif
#ifndef LIGHTS // 0: none
#define LIGHTS RUNTIME
#endif
#ifndef LIGHT_MAP // 0: no surface has a map of what shadows and caustics add to its light
#define LIGHT_MAP RUNTIME
#endif
#ifndef SKY
#define SKY RUNTIME
#endif
#ifndef LAMPS // 0: no round ones are in the sky
#define LAMPS RUNTIME
#endif
#ifndef BOXES // 0: no boxes are
#define BOXES RUNTIME
#endif
#ifndef HEAD // 0: the observer has none
#define HEAD RUNTIME
#endif
#ifndef BACKDROP // 0: the camera sees the sky
#define BACKDROP RUNTIME
#endif
#ifndef GLARE // 0: what the stone reflects outside, where the camera's rays meet it, is left out
#define GLARE RUNTIME
#endif
#ifndef DISPERSION // 0: one chain for the three channels
#define DISPERSION RUNTIME
#endif
#ifndef ABSORPTION // 0: none
#define ABSORPTION RUNTIME
#endif
#ifndef FRESNEL
#define FRESNEL RUNTIME
#endif
#ifndef END
#define END RUNTIME
#endif
#ifndef SPECTRAL // 1: sampled wavelengths, a chain each, that light all channels. Never RUNTIME.
#define SPECTRAL 0
#endif
#ifndef POLARISED // 1: chains carry the polarisation of light. Never RUNTIME.
#define POLARISED 0
#endif
#ifndef FEW_MIRRORS // 1: a stone reflects light into few directions, which are kept exactly. Never RUNTIME.
#define FEW_MIRRORS 0
#endif
#ifndef ALIKE // 1: MANY stones, all of one shape, which is met by its half-spaces. Never RUNTIME.
#define ALIKE 0
#endif
#ifndef RECORDED // 1: one ray is followed, and what it meets written down: path.cl alone. Never RUNTIME.
#define RECORDED 0
#endif
#ifndef CAMERA_INSIDE // 1: the camera is inside the stone
#define CAMERA_INSIDE RUNTIME
#endif

#define DECIDED(feature, parameter) ((feature) == RUNTIME ? (parameter) : (feature))

// Whether light inside a stone is followed in other axes than the world's.
#define INNER_AXES (GEOMETRY == HULL || STONES == MANY)

// Whether light that leaves a stone may meet a stone before it meets the room.
#define EXCHANGE (GEOMETRY == MESH || STONES == MANY)

// Whether light inside a stone waits for a full packet at facets that it passes in part: where one pool is enough for it, since a
// packet is of one shape. Polarised light is split at each facet.
#define WAITS_AT_FACETS (ALIKE && !POLARISED)

// Whether light that has left a stone can meet one again.
#define REENTRY                                                                                                        \
  (GEOMETRY != EMPTY && (EXCHANGE || FLOOR == MIRROR || FLOOR == RUNTIME || WALLS == MIRROR || WALLS == RUNTIME))

// A chain carries one channel where each has an index of its own; all three where they share one, and where the chain is
// of a wavelength, which all of them see a part of.
#define CHANNELS (SPECTRAL || DISPERSION == 0 ? 3 : 1)

// Neighbouring pixels take different wavelengths: GROUPS of chains, one for each pixel of a square.
#define SPECTRAL_GROUPS 4
#if SPECTRAL
#define GROUPS SPECTRAL_GROUPS
#else
#define GROUPS 1
#endif

// What belongs to a chain differs by lane where pixels differ in wavelength, or stones in material.
#if SPECTRAL || STONES == MANY
typedef realL chainL;
#else
typedef real chainL;
#endif

#endif
