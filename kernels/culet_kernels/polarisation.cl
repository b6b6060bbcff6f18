// The polarisation of light, as a path traced from the eye needs it: the first row of the product of Mueller matrices so
// far, which says what each Stokes parameter of light that enters the path's far end adds to the intensity at the eye.
//
// Light from sky and lights is unpolarised, so the row's first entry is the path's weight; the packet keeps that with the
// other weights, and here are the three others, divided by it. They refer to a frame: `axis` is perpendicular to the ray.
// Fresnel's matrices and the phases of total reflection: Born & Wolf, Principles of Optics, 1.5; Mueller calculus:
// Collett, Field Guide to Polarization (2005). p = k x s for the light that comes and for the light that goes, so that an
// ideal mirror is diag(1, 1, -1, -1). Fields of e^(-i w t) or e^(+i w t) differ in the sign of V everywhere, and in
// nothing else.
#ifndef CULET_POLARISATION
#define CULET_POLARISATION
#include "features.cl"
#include "fresnel.cl"

typedef struct {
  realL q, u, v;
  vec3L axis;
} polarisationL;

static inline polarisationL unpolarised(vec3L direction) {
  // Any axis will do: perpendicular to the ray, from whichever of x and z is farther from it.
  const maskL steep = fabs(direction.x) > fabs(direction.z);
  const vec3L axis =
      blend3(steep, vec3(-direction.y, direction.x, splat(0)), vec3(splat(0), direction.z, -direction.y));
  const polarisationL none = {splat(0), splat(0), splat(0), normalise(axis)};
  return none;
}

static inline polarisationL blend_polarisation(maskL mask, polarisationL yes, polarisationL no) {
  const polarisationL blended = {blend(mask, yes.q, no.q), blend(mask, yes.u, no.u), blend(mask, yes.v, no.v),
                                 blend3(mask, yes.axis, no.axis)};
  return blended;
}

// In an ideal mirror the field of each direction turns into minus its mirror image: the axis follows, the handedness flips.
static inline polarisationL mirror_polarisation(polarisationL p, vec3L normal) {
  const polarisationL mirrored = {p.q, -p.u, -p.v, reflect3(p.axis, dot3(p.axis, normal), normal)};
  return mirrored;
}

// Refers to the plane of incidence: the axis becomes s. At normal incidence, where any axis is as good, it stays.
static inline polarisationL align(polarisationL p, vec3L direction, vec3L normal) {
  const vec3L across = cross3(normal, direction);
  const realL squared = dot3(across, across);
  const maskL oblique = squared > (real)1e-10;
  const vec3L s = blend3(oblique, scale3(rsqrt(fmax(squared, splat((real)1e-10))), across), p.axis);
  const realL cosine = dot3(p.axis, s), sine = dot3(cross3(p.axis, direction), s); // light runs against the ray
  const realL cos_2 = cosine * cosine - sine * sine, sin_2 = 2 * sine * cosine;
  const polarisationL aligned = {p.q * cos_2 + p.u * sin_2, p.u * cos_2 - p.q * sin_2, p.v, s};
  return aligned;
}

// What a boundary does to light in the frame of its plane of incidence.
typedef struct {
  realL kept; // the part of the weight that is reflected; the rest is transmitted
  polarisationL reflected, transmitted;
} splitL;

// The row times [[a, b, 0, 0], [b, a, 0, 0], [0, 0, c, d], [0, 0, -d, c]], divided by its new first entry.
static inline polarisationL times(polarisationL p, realL a, realL b, realL c, realL d, realL first) {
  const realL inverse = (real)1 / fmax(first, splat((real)1e-12));
  const polarisationL product = {(b + a * p.q) * inverse, (c * p.u - d * p.v) * inverse, (d * p.u + c * p.v) * inverse,
                                 p.axis};
  return product;
}

// cos_a in air, cos_s in the stone; squared_a is cos_a^2 from Snell's law, negative where light inside is totally
// reflected. p must be aligned.
static inline splitL split(polarisationL p, realL cos_a, realL cos_s, realL squared_a, chainL eta) {
  const maskL total = squared_a <= 0;
  const realL rs = (cos_a - eta * cos_s) / (cos_a + eta * cos_s), rp = (eta * cos_a - cos_s) / (eta * cos_a + cos_s);
  const realL big_rs = rs * rs, big_rp = rp * rp;
  // Total reflection: r_s r_p* = Z / Z*, Z = eta (cos^2 + g^2) + i cos g (eta^2 - 1), with cos_a = i g.
  const realL g = sqrt(fmax(-squared_a, splat(0)));
  const realL real_z = eta * (cos_s * cos_s + g * g), imaginary_z = cos_s * g * (eta * eta - 1);
  const realL inverse = (real)1 / (real_z * real_z + imaginary_z * imaginary_z + (real)1e-30);
  const realL a = blend(total, splat(1), (real)0.5 * (big_rs + big_rp)),
              b = blend(total, splat(0), (real)0.5 * (big_rs - big_rp));
  const realL c = blend(total, (real_z * real_z - imaginary_z * imaginary_z) * inverse, rs * rp);
  const realL d = blend(total, 2 * real_z * imaginary_z * inverse, splat(0));
  splitL result;
  result.kept = clamp(a + b * p.q, (realL)0, (realL)1);
  result.reflected = times(p, a, b, c, d, result.kept);
  const realL through = sqrt(fmax(((real)1 - big_rs) * ((real)1 - big_rp), splat(0)));
  result.transmitted = times(p, (real)1 - a, -b, through, splat(0), (real)1 - result.kept);
  return result;
}

#endif
