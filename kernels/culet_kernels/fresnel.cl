// Snell's law and reflectance at the boundary between the stone (index eta) and air.
#ifndef CULET_FRESNEL
#define CULET_FRESNEL
#include "features.cl"
#include "vector.cl"

// Fresnel's equations for unpolarised light, the mean of both polarisations (Born & Wolf, Principles of Optics, 1.5.2).
// cos_a is the cosine in air and cos_s in the stone; the reflectance is the same from either side.
static inline realL fresnel_exact(realL cos_a, realL cos_s, chainL eta) {
  const realL r_perpendicular = (cos_a - eta * cos_s) / (cos_a + eta * cos_s);
  const realL r_parallel = (eta * cos_a - cos_s) / (eta * cos_a + cos_s);
  return (real)0.5 * (r_perpendicular * r_perpendicular + r_parallel * r_parallel);
}

static inline chainL reflectance_at_normal(chainL eta) {
  const chainL r = (eta - 1) / (eta + 1);
  return r * r;
}

// Schlick, An Inexpensive BRDF Model for Physically-based Rendering (1994), eq. 24.
static inline realL fresnel_schlick(realL cosine, chainL eta) {
  const chainL f0 = reflectance_at_normal(eta);
  const realL m = fmax((real)1 - cosine, (realL)0), m2 = m * m;
  return f0 + (1 - f0) * (m2 * m2 * m);
}

// Schlick's cosine is the one in air, where the angle is larger: with the one inside, it misses the critical angle.
static inline realL reflectance(int kind, realL cos_a, realL cos_s, chainL eta) {
  return kind == SCHLICK ? fresnel_schlick(cos_a, eta) : fresnel_exact(cos_a, cos_s, eta);
}

// Cosine in the stone of light that comes from air.
static inline realL cosine_in_stone(realL cos_a, chainL eta) {
  return sqrt(fmax((real)1 - ((real)1 - cos_a * cos_a) * ((real)1 / (eta * eta)), (realL)0));
}

// Square of the cosine in air of light that comes from inside; not positive where it is totally reflected.
static inline realL squared_cosine_in_air(realL cos_s, chainL eta) {
  return (real)1 - (eta * eta) * ((real)1 - cos_s * cos_s);
}

#endif
