// The lane types: the only file that knows how wide a packet is and how precise a number.
//
// A comparison yields 1 for scalars but -1 in each component of a vector, and select() looks at the top bit of vectors
// only (OpenCL C 3.0, 6.4.4 and 6.15.6), so masks are used through the functions below and `!`, `&`, `|` alone.
#ifndef CULET_LANES
#define CULET_LANES

#ifndef LANES // 1, 4, 8 or 16
#define LANES 16
#endif
#ifndef REAL // float or double
#define REAL float
#endif

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define IS_DOUBLE_float 0
#define IS_DOUBLE_double 1
#define IS_DOUBLE JOIN(IS_DOUBLE_, REAL)

#if IS_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define MASK long
#define SIGN_BIT LONG_MIN
#else
#define MASK int
#define SIGN_BIT INT_MIN
#endif

#ifndef __has_builtin
#define __has_builtin(name) 0
#endif

// Whether 16 numbers of single precision have the processor's own instructions for masks and for packing: OpenCL has none
// for packing, and PoCL's any() is many.
#if !IS_DOUBLE && defined(__AVX512F__) && defined(__AVX512DQ__) && __has_builtin(__builtin_ia32_compresssi512_mask) && \
    __has_builtin(__builtin_ia32_permvarsf512) && __has_builtin(__builtin_ia32_permvarsi512) &&                        \
    __has_builtin(__builtin_ia32_vpermi2varps512) && __has_builtin(__builtin_ia32_pternlogd512_mask)
#define AVX512 1
#else
#define AVX512 0
#endif

typedef REAL real;
typedef JOIN(REAL, 4) real4;

#if LANES == 1
typedef real realL;
typedef int intL;
typedef int maskL;
typedef MASK bitsL;
#define AS_BITS JOIN(as_, MASK)
#define AS_REAL JOIN(as_, REAL)
#define PACKET_WIDTH 1
#define PACKET_HEIGHT 1
#define LANE_INDEX 0
static inline realL blend(maskL mask, realL yes, realL no) { return mask ? yes : no; }
static inline int any_lane(maskL mask) { return mask; }
static inline realL load_lanes(const real *from) { return *from; }
static inline intL load_ints(const int *from) { return *from; }
static inline void store_lanes(realL value, real *to) { *to = value; }
static inline void store_ints(intL value, int *to) { *to = value; }
static inline void store_mask(maskL mask, int *to) { *to = mask; }
static inline intL count_mask(maskL mask) { return mask; }
static inline maskL widen(intL mask) { return mask; }
static inline intL blend_ints(intL mask, intL yes, intL no) { return mask ? yes : no; }
static inline intL blend_ints_by(maskL mask, intL yes, intL no) { return mask ? yes : no; }
#else
typedef JOIN(REAL, LANES) realL;
typedef JOIN(int, LANES) intL;
typedef JOIN(MASK, LANES) maskL;
typedef maskL bitsL;
#define AS_BITS JOIN(JOIN(as_, MASK), LANES)
#define AS_REAL JOIN(JOIN(as_, REAL), LANES)
#if LANES == 4
#define PACKET_WIDTH 2
#define PACKET_HEIGHT 2
#define LANE_INDEX (intL)(0, 1, 2, 3)
#elif LANES == 8
#define PACKET_WIDTH 4
#define PACKET_HEIGHT 2
#define LANE_INDEX (intL)(0, 1, 2, 3, 4, 5, 6, 7)
#elif LANES == 16
#define PACKET_WIDTH 4
#define PACKET_HEIGHT 4
#define LANE_INDEX (intL)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#endif
static inline realL blend(maskL mask, realL yes, realL no) { return select(no, yes, mask); }
#if LANES == 16 && AVX512
static inline int any_lane(maskL mask) { return __builtin_ia32_cvtd2mask512(mask) != 0; }
#else
static inline int any_lane(maskL mask) { return any(mask); }
#endif
// A packet at any address, in one piece: PoCL makes several of vload and vstore.
typedef realL anywhereL __attribute__((aligned(sizeof(real)), may_alias));
typedef intL ints_anywhereL __attribute__((aligned(sizeof(int)), may_alias));
static inline realL load_lanes(const real *from) { return *(const anywhereL *)from; }
static inline intL load_ints(const int *from) { return *(const ints_anywhereL *)from; }
static inline void store_lanes(realL value, real *to) { *(anywhereL *)to = value; }
static inline void store_ints(intL value, int *to) { *(ints_anywhereL *)to = value; }
static inline void store_mask(maskL mask, int *to) { store_ints(JOIN(convert_int, LANES)(mask), to); }
static inline intL count_mask(maskL mask) { return -JOIN(convert_int, LANES)(mask); }
static inline maskL widen(intL mask) { return JOIN(JOIN(convert_, MASK), LANES)(mask); }
static inline intL blend_ints(intL mask, intL yes, intL no) { return select(no, yes, mask); }
static inline intL blend_ints_by(maskL mask, intL yes, intL no) {
  return select(no, yes, JOIN(convert_int, LANES)(mask));
}
#endif
#define PACKET_X (LANE_INDEX % PACKET_WIDTH)
#define PACKET_Y (LANE_INDEX / PACKET_WIDTH)

#if LANES == 1
typedef double doubleL;
static inline doubleL load_doubles(const double *from) { return *from; }
static inline doubleL to_double(realL value) { return value; }
static inline realL ints_to_real(intL value) { return (real)value; }
static inline intL reals_to_int(realL value) { return (int)value; }
static inline intL exponent_of(intL value) { return as_int((float)value) >> 23 & 255; }
static inline doubleL ints_to_double(intL value) { return value; }
static inline realL from_double(doubleL value) { return (real)value; }
#else
typedef JOIN(double, LANES) doubleL;
static inline doubleL load_doubles(const double *from) { return JOIN(vload, LANES)(0, from); }
static inline doubleL to_double(realL value) { return JOIN(convert_double, LANES)(value); }
static inline realL ints_to_real(intL value) { return JOIN(JOIN(convert_, REAL), LANES)(value); }
static inline intL reals_to_int(realL value) { return JOIN(convert_int, LANES)(value); }
static inline intL exponent_of(intL value) {
  return JOIN(as_int, LANES)(JOIN(convert_float, LANES)(value)) >> 23 & 255;
}
static inline doubleL ints_to_double(intL value) { return JOIN(convert_double, LANES)(value); }
static inline realL from_double(doubleL value) { return JOIN(JOIN(convert_, REAL), LANES)(value); }
#endif

// Which bit it is that is set, if one is.
static inline intL bit_number(intL bit) { return exponent_of(bit) - 127; }

// Numbers that lie anywhere, by their places: those of a work-item, those on the device, and those of single precision there.
#if LANES == 16 && AVX512 && __has_builtin(__builtin_ia32_gathersiv16sf)
#define GATHER(name, numbers)                                                                                          \
  static inline realL name(numbers from, intL place) {                                                                 \
    return __builtin_ia32_gathersiv16sf((realL)0, from, place, 0xffff, sizeof *from);                                  \
  }
#else
#define GATHER(name, numbers)                                                                                          \
  static inline realL name(numbers from, intL place) {                                                                 \
    int own[LANES];                                                                                                    \
    real found[LANES];                                                                                                 \
    store_ints(place, own);                                                                                            \
    for (int lane = 0; lane < LANES; lane++) found[lane] = from[own[lane]];                                            \
    return load_lanes(found);                                                                                          \
  }
#endif
GATHER(gather_lanes, const real *)
GATHER(gather_reals, __global const real *)
GATHER(gather_floats, __global const float *)
#undef GATHER

// The lanes that a mask names, in order and without gaps (stream compaction). A whole packet is written, of which `count` lanes are meant.
#if LANES == 16 && AVX512
typedef struct {
  intL from;
  int count;
} packing_t;
static inline packing_t packing_of(maskL mask) { // a permutation takes a fifth of a compression's time
  const ushort lanes = __builtin_ia32_cvtd2mask512(mask);
  const packing_t packing = {__builtin_ia32_compresssi512_mask(LANE_INDEX, LANE_INDEX, lanes), popcount((uint)lanes)};
  return packing;
}
static inline void pack_lanes(packing_t packing, realL value, real *to) {
  store_lanes(__builtin_ia32_permvarsf512(value, packing.from), to);
}
static inline void pack_ints(packing_t packing, intL value, int *to) {
  store_ints(__builtin_ia32_permvarsi512(value, packing.from), to);
}
#else
typedef struct {
  int place[LANES], count;
} packing_t;
static inline packing_t packing_of(maskL mask) {
  packing_t packing;
  int keep[LANES];
  store_mask(mask, keep);
  packing.count = 0;
  for (int lane = 0; lane < LANES; lane++) {
    packing.place[lane] = packing.count;
    packing.count += keep[lane] != 0;
  }
  return packing;
}
static inline void pack_lanes(packing_t packing, realL value, real *to) {
  real lanes[LANES];
  store_lanes(value, lanes);
  for (int lane = 0; lane < LANES; lane++) to[packing.place[lane]] = lanes[lane];
}
static inline void pack_ints(packing_t packing, intL value, int *to) {
  int lanes[LANES];
  store_ints(value, lanes);
  for (int lane = 0; lane < LANES; lane++) to[packing.place[lane]] = lanes[lane];
}
#endif

// A number of a packet to its row, or from the row, and on to the next of rows that lie `stride` numbers apart.
#define PACK_NUMBER(number)                                                                                            \
  pack_lanes(packing, number, rows);                                                                                   \
  rows += stride;
#define LOAD_NUMBER(number)                                                                                            \
  number = load_lanes(rows);                                                                                           \
  rows += stride;

// The number of the first lane that a mask names; there must be one.
#if LANES == 1
static inline int first_number(maskL mask, intL number) { return number; }
#else
static inline int first_number(maskL mask, intL number) {
  int own[LANES];
  store_ints(number, own);
#if LANES == 16 && AVX512
  const uint lanes = (ushort)__builtin_ia32_cvtd2mask512(mask);
  return own[popcount((lanes & -lanes) - 1)];
#else
  int keep[LANES], lane = 0;
  store_mask(mask, keep);
  while (!keep[lane]) lane++;
  return own[lane];
#endif
}
#endif

// For each k below a small number that is known at compile time. PoCL does not unroll all that it could by itself, and a loop
// that is left keeps its quantities in memory.
#define EACH(k, number) _Pragma("unroll") for (int k = 0; k < (number); k++)

static inline realL splat(real value) { return (realL)(value); }

// x, or -x where `sign` is negative.
static inline realL flip(realL x, realL sign) {
#if LANES == 16 && AVX512
  return AS_REAL(__builtin_ia32_pternlogd512_mask(AS_BITS(x), AS_BITS(sign), (bitsL)(SIGN_BIT), 0x78, 0xffff));
#else
  return AS_REAL(AS_BITS(x) ^ (AS_BITS(sign) & (bitsL)(SIGN_BIT)));
#endif
}

// Clang's is one instruction, PoCL's is several.
#if __has_builtin(__builtin_elementwise_floor)
static inline realL floor_lanes(realL x) { return __builtin_elementwise_floor(x); }
#else
static inline realL floor_lanes(realL x) { return floor(x); }
#endif

// Fast where the reference in double precision shows it to be exact enough, full where real is double.
#if IS_DOUBLE
static inline realL exp_fast(realL x) { return exp(x); }
#else
static inline realL exp_fast(realL x) { return native_exp(x); }
#endif

#endif
