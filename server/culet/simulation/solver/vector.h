/* Vectors, 3 x 3 matrices and unit quaternions w, x, y, z in double precision.
 *
 * Only +, -, x, / and sqrt, which IEEE 754 rounds in one way, so that a run is the same to the bit wherever it is
 * compiled. That also needs -ffp-contract=off, and doubles that are not kept in wider registers. */
#ifndef CULET_VECTOR_H
#define CULET_VECTOR_H

#include <float.h>
#include <math.h>

#if FLT_EVAL_METHOD != 0
#error "the solver needs arithmetic that rounds every double: on x86 of 32 bits compile with -msse2 -mfpmath=sse"
#endif

typedef struct {
  double x, y, z;
} Vec3;

/* By rows. */
typedef struct {
  Vec3 a, b, c;
} Mat3;

typedef struct {
  double w, x, y, z;
} Quat;

static const Vec3 ZERO = {0, 0, 0};

static inline Vec3 vec(double x, double y, double z) { return (Vec3){x, y, z}; }
static inline Vec3 add(Vec3 p, Vec3 q) { return vec(p.x + q.x, p.y + q.y, p.z + q.z); }
static inline Vec3 sub(Vec3 p, Vec3 q) { return vec(p.x - q.x, p.y - q.y, p.z - q.z); }
static inline Vec3 scaled(Vec3 p, double s) { return vec(p.x * s, p.y * s, p.z * s); }
static inline Vec3 negated(Vec3 p) { return vec(-p.x, -p.y, -p.z); }
static inline double dot(Vec3 p, Vec3 q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
static inline double length(Vec3 p) { return sqrt(dot(p, p)); }
static inline Vec3 cross(Vec3 p, Vec3 q) {
  return vec(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
}

static inline double smaller(double x, double y) { return x < y ? x : y; }
static inline double larger(double x, double y) { return x > y ? x : y; }

static inline Vec3 times(const Mat3 *m, Vec3 v) { return vec(dot(m->a, v), dot(m->b, v), dot(m->c, v)); }
static inline Vec3 transposed_times(const Mat3 *m, Vec3 v) {
  return vec(m->a.x * v.x + m->b.x * v.y + m->c.x * v.z, m->a.y * v.x + m->b.y * v.y + m->c.y * v.z,
             m->a.z * v.x + m->b.z * v.y + m->c.z * v.z);
}

/* r s r', of a symmetric s. */
static inline Mat3 turned_tensor(const Mat3 *r, const Mat3 *s) {
  Vec3 a = times(s, r->a), b = times(s, r->b), c = times(s, r->c);
  double xy = dot(a, r->b), xz = dot(a, r->c), yz = dot(b, r->c);
  return (Mat3){{dot(a, r->a), xy, xz}, {xy, dot(b, r->b), yz}, {xz, yz, dot(c, r->c)}};
}

static inline Mat3 rotation_matrix(Quat q) {
  double w = q.w, x = q.x, y = q.y, z = q.z;
  return (Mat3){{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

/* The rotation q, then p. */
static inline Quat product(Quat p, Quat q) {
  return (Quat){p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z, p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
                p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x, p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w};
}

static inline Quat normalised(Quat q) {
  double norm = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return (Quat){q.w / norm, q.x / norm, q.y / norm, q.z / norm};
}

/* q, turned on by the Gibbs vector u: the axis times the tangent of half the angle. */
static inline Quat cayley(Quat q, Vec3 u) { return normalised(product((Quat){1, u.x, u.y, u.z}, q)); }

static inline Vec3 rotated(Quat q, Vec3 v) {
  Vec3 u = vec(q.x, q.y, q.z), t = scaled(cross(u, v), 2);
  return add(v, add(scaled(t, q.w), cross(u, t)));
}

static inline Vec3 rotated_back(Quat q, Vec3 v) { return rotated((Quat){q.w, -q.x, -q.y, -q.z}, v); }

#endif
