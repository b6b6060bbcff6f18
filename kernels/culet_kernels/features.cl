// What a program contains. Each feature is one -D with a kind of scene as its value; RUNTIME, the default, leaves the
// choice to the parameters, so a program without any -D renders every scene. A fixed value folds the choice away at
// compile time: the code of the other kinds is not in the program. No other file looks at a feature except through the
// macros at the end of this one.
#ifndef CULET_FEATURES
#define CULET_FEATURES

#define RUNTIME (-1)

// Kinds of surface for FLOOR and WALLS.
#define NONE 0
#define MATTE 1
#define MIRROR 2

// Kinds of SKY.
#define CONSTANT 0
#define GRADIENT 1
#define HALF 2
#define STUDIO 3

// Kinds of GEOMETRY: no stone, facet half-spaces, or triangles in a tree. Never RUNTIME.
#define EMPTY 0
#define HULL 1
#define MESH 2

// Kinds of FRESNEL.
#define EXACT 0
#define SCHLICK 1

#ifndef GEOMETRY
#define GEOMETRY HULL
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
#ifndef SKY
#define SKY RUNTIME
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
#ifndef CAMERA_INSIDE // 1: the camera is inside the stone
#define CAMERA_INSIDE RUNTIME
#endif

#define DECIDED(feature, parameter) ((feature) == RUNTIME ? (parameter) : (feature))

// Whether light that has left the stone can meet it again.
#define REENTRY (GEOMETRY != EMPTY && (GEOMETRY == MESH || FLOOR == MIRROR || FLOOR == RUNTIME || WALLS == MIRROR || WALLS == RUNTIME))

// A chain carries one channel where the index depends on it, all three where it does not.
#define CHANNELS (DISPERSION == 0 ? 3 : 1)
#define CHAINS (DISPERSION == 0 ? 1 : 3)

#endif
