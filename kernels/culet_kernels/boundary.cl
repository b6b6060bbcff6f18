// What a stone's surface makes of a packet of light: shares, directions and polarisation of what is reflected and of what
// goes through.
#ifndef CULET_BOUNDARY
#define CULET_BOUNDARY
#include "fresnel.cl"
#include "packet.cl"
#include "world.cl"

// The boundary's reflectance for a packet, and its polarisation on either side.
static inline splitL meet_boundary(world_t world, const packetL *packet, vec3L normal, realL cos_a, realL cos_s,
                                   realL squared_a, chainL eta) {
  splitL result;
  if (POLARISED) return split(align(packet->polarisation, packet->direction, normal), cos_a, cos_s, squared_a, eta);
  const int fresnel_kind = DECIDED(FRESNEL, world.scene->fresnel_kind);
  result.kept = blend(squared_a > 0, reflectance(fresnel_kind, cos_a, cos_s, eta), splat(1));
  result.reflected = result.transmitted = packet->polarisation;
  return result;
}

// The direction of light that goes in, and of light that goes out.
static inline vec3L refract_inward(vec3L direction, realL cos_a, realL cos_s, chainL eta, vec3L normal) {
  const realL ratio = splat(1) / eta;
  return renormalise(along(scale3(ratio, direction), ratio * cos_a - cos_s, normal));
}
static inline vec3L refract_outward(vec3L direction, realL cos_a, realL cos_s, chainL eta, vec3L normal) {
  return renormalise(along(scale3((realL)(eta), direction), cos_a - eta * cos_s, normal));
}

// The direction of what stays inside. Where light comes back to the same directions for thousands of reflections, they are
// made in double precision: rounded at each step, directions drift past the critical angle (rendering/stones/mirrors.py).
static inline vec3L reflect_inside(__constant const stone_t *stone, vec3L direction, realL cos_s, vec3L normal) {
  if (FEW_MIRRORS == 0 ? 1 : STONES == MANY ? !stone->few_mirrors : 0)
    return renormalise(reflect3(direction, cos_s, normal));
  const doubleL x = to_double(direction.x), y = to_double(direction.y), z = to_double(direction.z),
                nx = to_double(normal.x), ny = to_double(normal.y), nz = to_double(normal.z);
  const doubleL twice = -2 * (x * nx + y * ny + z * nz) / (nx * nx + ny * ny + nz * nz);
  const doubleL rx = fma(twice, nx, x), ry = fma(twice, ny, y), rz = fma(twice, nz, z);
  const doubleL scale = 1.5 - 0.5 * (rx * rx + ry * ry + rz * rz); // to unit length
  return vec3(from_double(scale * rx), from_double(scale * ry), from_double(scale * rz));
}

#endif
