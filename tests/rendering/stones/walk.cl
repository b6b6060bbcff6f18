// Light that is reflected by a mesh from inside, again and again, with nothing else of the renderer around it.

// Rays come from outside, are refracted, and take `bounces` reflections. Of each ray the number of those that it found, -1
// where it missed the stone, and the farthest that it came from the stone's centre.
__kernel void walk(__constant const stone_t *stone, __global const real *boxes, __global const int *links,
                   __global const real *corners, __global const real *rays, real eta, int bounces, __global int *found,
                   __global real *farthest) {
  const size_t first = get_global_id(0) * LANES, count = get_global_size(0) * LANES;
  const tree_t tree = {boxes, links, corners};
  realL ray[6];
  for (int k = 0; k < 6; k++) {
    real row[LANES];
    for (int lane = 0; lane < LANES; lane++) row[lane] = rays[k * count + first + lane];
    ray[k] = load_lanes(row);
  }
  vec3L origin = vec3(ray[0], ray[1], ray[2]), direction = vec3(ray[3], ray[4], ray[5]);
  const maskL all = ray[0] <= ray[0];
  crossingL crossing = mesh_crossing(stone, tree, origin, direction, splat(0), (real)1e30, all, 1);
  maskL inside = crossing.hit;
  const realL cos_a = clamp(-dot3(direction, crossing.normal), (realL)0, (realL)1);
  const realL cos_s = sqrt((real)1 - ((real)1 - cos_a * cos_a) / (eta * eta));
  origin = along(origin, crossing.t, direction);
  direction = renormalise(along(scale3(splat(1 / eta), direction), cos_a / eta - cos_s, crossing.normal));
  intL number = count_mask(inside) - 1;
  number += count_mask(all) - 1; // -1 where it missed
  realL squared = splat(0);
  for (int bounce = 0; bounce < bounces && any_lane(inside); bounce++) {
    crossing = mesh_crossing(stone, tree, origin, direction, splat(0), (real)1e30, inside, -1);
    inside &= crossing.hit;
    number += count_mask(inside);
    origin = along(origin, crossing.t, direction);
    squared = blend(inside, fmax(squared, dot3(origin, origin)), squared);
    const vec3L back = renormalise(reflect3(direction, dot3(direction, crossing.normal), crossing.normal));
    direction = blend3(inside, back, direction);
  }
  int numbers[LANES];
  real lengths[LANES];
  store_ints(number, numbers);
  store_lanes(sqrt(squared), lengths);
  for (int lane = 0; lane < LANES; lane++) {
    found[first + lane] = numbers[lane];
    farthest[first + lane] = lengths[lane];
  }
}
