// Where beams end: on floor and walls, each beam on whichever of them it meets first.
#ifndef CULET_LANDING
#define CULET_LANDING
#include "light_beam.cl"

#define SHADOW_OF_LIGHT 1
#define LIGHT_ITSELF 0
#define TWISTED ((real)0.02) // share of its turns that a polygon may make the wrong way round

static inline real gap_to(__constant const throwing_t *room, int s, const real *p) {
  return room->surface[s][0] * p[0] + room->surface[s][1] * p[1] + room->surface[s][2] * p[2] - room->surface[s][3];
}
static inline real speed_to(__constant const throwing_t *room, int s, const real *d) {
  return -(room->surface[s][0] * d[0] + room->surface[s][1] * d[1] + room->surface[s][2] * d[2]);
}

// The part of a polygon's area that lies on a map.
static inline real part_on_map(const real *x, const real *y, int count) {
  real fx[2][CLIPPED + 4], fy[2][CLIPPED + 4];
  for (int i = 0; i < count; i++) {
    fx[0][i] = x[i];
    fy[0][i] = y[i];
  }
  int side = 0, left = count;
  for (int edge = 0; edge < 4 && left > 2; edge++) {
    int kept = 0;
    for (int i = 0; i < left; i++) {
      const int next = i + 1 == left ? 0 : i + 1;
      const real at = edge < 2 ? fx[side][i] : fy[side][i], then = edge < 2 ? fx[side][next] : fy[side][next];
      const real inside = edge & 1 ? MAP_SIZE - at : at, follows = edge & 1 ? MAP_SIZE - then : then;
      if (inside >= 0) {
        fx[1 - side][kept] = fx[side][i];
        fy[1 - side][kept++] = fy[side][i];
      }
      if ((inside < 0) != (follows < 0)) {
        const real part = inside / (inside - follows);
        fx[1 - side][kept] = mix_of(fx[side][i], fx[side][next], part);
        fy[1 - side][kept++] = mix_of(fy[side][i], fy[side][next], part);
      }
    }
    left = kept;
    side = 1 - side;
  }
  if (left < 3) return 0;
  const real whole = fabs(polygon_area(x, y, count));
  return whole > 0 ? fmin(fabs(polygon_area(fx[side], fy[side], left)) / whole, (real)1) : 1;
}

// Where the corners land on a surface, along its rows and columns. Those of a beam of a point cross over each other near
// grazing angles, at last; then all of them take the common way.
static inline void land_corners(__constant const throwing_t *room, int s, const corner_t *corners, int count,
                                const real *common, int straighten, real *u, real *v) {
  for (int parallel = 0; parallel < 2; parallel++) {
    for (int i = 0; i < count; i++) {
      const real *d = parallel ? common : way_of(corners + i, common), *p = corners[i].p;
      const real t = fmax(gap_to(room, s, p), (real)0) / fmax(speed_to(room, s, d), GRAZING);
      u[i] = v[i] = 0;
      for (int k = 0; k < 3; k++) {
        u[i] += room->across[s][k] * (p[k] + t * d[k]);
        v[i] += room->up[s][k] * (p[k] + t * d[k]);
      }
    }
#if DIVERGING
    if (!straighten) return;
    real left = 0, right = 0;
    for (int i = 0; i < count; i++) {
      const int j = i + 1 == count ? 0 : i + 1, k = j + 1 == count ? 0 : j + 1;
      const real turn = (u[j] - u[i]) * (v[k] - v[j]) - (u[k] - u[j]) * (v[j] - v[i]);
      left += fmax(turn, (real)0);
      right -= fmin(turn, (real)0);
    }
    if (fmin(left, right) <= TWISTED * fmax(left, right)) return;
#else
    return;
#endif
  }
}

// The part of a beam that a surface is the first to meet. Returns the number of its corners, which are in `*of`.
static inline int first_met(__constant const throwing_t *room, int s, const corner_t *corners, int count,
                            const real *common, corner_t (*room_for)[CLIPPED], const corner_t **of) {
  real inside[CLIPPED];
  int side = 0;
  *of = corners;
  for (int other = -2; other < MAX_SURFACES; other++) {
    if (other >= 0 && (other == s || !room->present[other])) continue;
    int out = 0;
    for (int i = 0; i < count; i++) {
      const corner_t *corner = *of + i;
      const real *d = way_of(corner, common);
      const real speed = speed_to(room, s, d), gap = gap_to(room, s, corner->p);
      if (other == -2)
        inside[i] = speed - GRAZING * sqrt(dot_3(d, d));
      else if (other == -1)
        inside[i] = gap;
      else { // t of this surface against the other's, both times speeds that are not negative
        const real faster = speed_to(room, other, d);
        inside[i] = faster > 0 ? gap_to(room, other, corner->p) * speed - gap * faster : (real)1;
      }
      out += inside[i] < 0;
    }
    if (out == 0) continue;
    if (out == count) return 0;
    count = clip_corners(*of, count, inside, room_for[side], CLIPPED);
    *of = room_for[side];
    side = 1 - side;
    if (count < 3) return 0;
  }
  return count;
}

// A beam that meets no stone any more, on the maps of floor and walls. `height` is, of a shadow, what it takes.
static inline void land(__constant const throwing_t *room, canvas_t canvas, tally_t *tally,
                        __constant const light_t *light, const corner_t *corners, int count, const real *common,
                        real flux, float4 colour, real weight, real power, int doubtful, int shadow) {
  real left = flux, behind = 0;
  const size_t plane = (size_t)MAP_SIZE * MAP_STRIDE;
  for (int s = 0; s < MAX_SURFACES; s++) {
    if (!room->present[s]) continue;
    corner_t cut[2][CLIPPED];
    const corner_t *part;
    const int met = first_met(room, s, corners, count, common, cut, &part);
    if (met < 3) continue;
    real share = flux;
    if (!shadow && part != corners)
      share *= fmin(measure(part, met) / fmax(measure(corners, count), (real)1e-30), (real)1);
    if (!shadow) share = fmin(share, left);
    left -= share;
    if (!room->mapped[s]) {
      tally->away += weight * share;
      continue;
    }
    real u[CLIPPED], v[CLIPPED], x[CLIPPED], y[CLIPPED];
    land_corners(room, s, part, met, common, !shadow, u, v);
    real scale_flux = share;
#if DIVERGING
    if (!shadow) { // light without falloff: what lands far from the point counts as if it were as near as the stones
      real mean[3] = {0, 0, 0}, mu = 0, mv = 0, squared = 0;
      for (int i = 0; i < met; i++) {
        mu += u[i] / met;
        mv += v[i] / met;
      }
      for (int k = 0; k < 3; k++) {
        mean[k] =
            room->across[s][k] * mu + room->up[s][k] * mv + room->surface[s][k] * room->surface[s][3] - light->place[k];
        squared += mean[k] * mean[k];
      }
      scale_flux *= squared / light->squared;
    }
#endif
    real on_map = 1;
    for (int level = 0; level < MAP_LEVELS; level++) {
      const real scale = MAP_SIZE / (2 * room->half_size[level]);
      real low_x = 1e30f, high_x = -1e30f, low_y = 1e30f, high_y = -1e30f;
      for (int i = 0; i < met; i++) {
        x[i] = (u[i] - room->centre[s][0] + room->half_size[level]) * scale;
        y[i] = (v[i] - room->centre[s][1] + room->half_size[level]) * scale;
        low_x = fmin(low_x, x[i]);
        high_x = fmax(high_x, x[i]);
        low_y = fmin(low_y, y[i]);
        high_y = fmax(high_y, y[i]);
      }
      const int within = low_x >= 0 && low_y >= 0 && high_x <= MAP_SIZE && high_y <= MAP_SIZE;
      const int apart = high_x <= 0 || high_y <= 0 || low_x >= MAP_SIZE || low_y >= MAP_SIZE;
      if (level == MAP_LEVELS - 1 && !within && !shadow) on_map = apart ? 0 : part_on_map(x, y, met);
      if (apart) continue;
      const int number = s * MAP_LEVELS + level, row = number * MAP_SIZE;
      if (!shadow) {
        raster_polygon(canvas.light + number * plane, canvas.lit + row, x, y, met,
                       colour * (float)(scale_flux * scale * scale));
        if (doubtful && level == 0 && within) {
          const real area = fabs(polygon_area(x, y, met)) / (scale * scale);
          tally->doubt += power * scale_flux * scale_flux / fmax(area, 1 / (scale * scale));
        }
        continue;
      }
      const int turn = polygon_area(x, y, met) > 0 ? -1 : 1;
      for (int i = 0; i < met; i++) {
        const int next = i + 1 == met ? 0 : i + 1;
#if DIVERGING
        const int of_point = light->shade * room->maps * MAP_LEVELS;
        raster_shade(canvas.shade + (of_point + number) * plane, canvas.shaded + of_point * MAP_SIZE + row, x[i], y[i],
                     x[next], y[next], (float)turn);
#else
        raster_side(canvas.light + number * plane, canvas.lit + row, x[i], y[i], x[next], y[next],
                    colour * (float)(-turn * fmax(speed_to(room, s, common), (real)0)));
#endif
      }
    }
    tally->landed += weight * share * on_map;
    tally->outside += weight * share * (1 - on_map);
  }
  if (shadow) return;
  // What is left lies behind a surface that it goes towards, or passes all of them by.
  for (int i = 0; i < count; i++)
    for (int s = 0; s < MAX_SURFACES; s++)
      if (room->present[s] && gap_to(room, s, corners[i].p) < 0 && speed_to(room, s, common) > 0) behind = 1;
  if (behind > 0)
    tally->behind += weight * fmax(left, (real)0);
  else
    tally->away += weight * fmax(left, (real)0);
}

#endif
