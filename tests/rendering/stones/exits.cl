// Where light inside a convex stone leaves, by its facets one by one and by its rows; all in the axes of the rows.
__kernel void exits(__global const real4 *facets, int count, __global const real4 *rows, __constant const int *ends,
                    __global const real *rays, __global real *found) {
  real numbers[6][LANES], out[2][5][LANES];
  for (int k = 0; k < 6; k++)
    for (int lane = 0; lane < LANES; lane++) numbers[k][lane] = rays[(get_global_id(0) * 6 + k) * LANES + lane];
  const vec3L origin = load3(numbers), direction = load3(numbers + 3);
  const crossingL crossing[2] = {hull_exit(facets, count, origin, direction),
                                 rows_exit(rows_of(rows, ends), origin, direction)};
  for (int i = 0; i < 2; i++) {
    store_lanes(crossing[i].t, out[i][0]);
    store3(crossing[i].normal, out[i] + 1);
    store_lanes(blend(crossing[i].hit, splat(1), splat(0)), out[i][4]);
  }
  for (int k = 0; k < 2 * 5 * LANES; k++) found[get_global_id(0) * 2 * 5 * LANES + k] = out[0][0][k];
}
