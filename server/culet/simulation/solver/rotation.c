/* Free rotation: how the orientation follows from a constant angular momentum L (free_rotation.py has the derivation).
 *
 * A classical Runge-Kutta step on the Gibbs vector u of the turn since the step began (RKMK4 with the Cayley map):
 *
 *     u' = (omega + omega x u + (omega . u) u) / 2,   u(0) = 0,   omega = R I^-1 R' L
 *
 * Of needles and wafers such a step's error, divided by the smallest moment, would become a spin that was never there:
 * these are turned as the symmetric tops that they nearly are, exactly, and what is left is split off. */
#include "solver.h"

#define MAX_TURN 0.125   /* rad: a longer step is divided */
#define MAX_DIVISIONS 64 /* beyond, a stone is turned about its angular momentum */
#define STIFF 20.0       /* ratio of the largest to the smallest moment from which on a body is turned as a top */

#define TWO_OVER_PI 0.63661977236758134308
#define HALF_PI_HIGH 1.57079632673412561417 /* its first 33 bits: products with small integers are exact */
#define HALF_PI_LOW 6.0771005065061922e-11

void refresh(Body *body) {
  body->axes = rotation_matrix(body->orientation);
  body->world_inverse_inertia = turned_tensor(&body->axes, &body->inverse_inertia);
  body->spin = times(&body->world_inverse_inertia, body->angular_momentum);
}

Vec3 angular_momentum_of(const Body *body, Vec3 spin) {
  return times(&body->axes, times(&body->inertia, transposed_times(&body->axes, spin)));
}

/* How far a small turn moves any point of the hull, R; or how fast a spin does. A needle's about its length hardly does. */
double farthest_moved(const Body *body, Vec3 turn) {
  Vec3 inside = transposed_times(&body->axes, turn);
  double most = 0;
  for (int i = 0; i < body->hull.vertex_count; i++) {
    Vec3 moved = cross(inside, hull_vertex(&body->hull, i));
    most = larger(most, dot(moved, moved));
  }
  return sqrt(most);
}

/* By Taylor's series within an eighth of a turn: to 1e-16, and the same bits everywhere, as no library promises. */
static void sine_cosine(double angle, double *sine, double *cosine) {
  double quarters = floor(angle * TWO_OVER_PI + 0.5);
  double r = (angle - quarters * HALF_PI_HIGH) - quarters * HALF_PI_LOW;
  double q = r * r;
  double s =
      r * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156 * (1 - q / 210)))))));
  double c = 1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90 * (1 - q / 132 * (1 - q / 182))))));
  int quadrant = (int)(quarters - 4 * floor(quarters / 4));
  *sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
  *cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

static Quat turn_about(Vec3 axis, double angle) {
  double sine, cosine;
  sine_cosine(angle / 2, &sine, &cosine);
  return (Quat){cosine, sine * axis.x, sine * axis.y, sine * axis.z};
}

static Vec3 gibbs_rate(const Body *body, Quat start, Vec3 momentum, Vec3 u) {
  Quat q = cayley(start, u);
  Vec3 omega = rotated(q, times(&body->inverse_inertia, rotated_back(q, momentum)));
  return scaled(add(add(omega, cross(omega, u)), scaled(u, dot(omega, u))), 0.5);
}

static Quat rkmk4(const Body *body, Quat q, Vec3 momentum, double h) {
  Vec3 first = gibbs_rate(body, q, momentum, ZERO);
  Vec3 second = gibbs_rate(body, q, momentum, scaled(first, h / 2));
  Vec3 third = gibbs_rate(body, q, momentum, scaled(second, h / 2));
  Vec3 fourth = gibbs_rate(body, q, momentum, scaled(third, h));
  return cayley(q, scaled(add(add(first, fourth), scaled(add(second, third), 2)), h / 6));
}

static double along_axis(Quat q, Vec3 momentum, Vec3 axis) { return dot(rotated_back(q, momentum), axis); }

/* Exact for a body whose other two moments are 1 / across. */
static Quat top_turn(Quat q, Vec3 momentum, Vec3 axis, double moment, double across, double time) {
  q = product(q, turn_about(axis, along_axis(q, momentum, axis) * (1 / moment - across) * time));
  double size = length(momentum);
  return size > 0 ? product(turn_about(scaled(momentum, 1 / size), size * across * time), q) : q;
}

static Quat symmetric_top(const Body *body, Quat q, Vec3 momentum, double h) {
  const double *moments = body->moments;
  Vec3 axis = body->principal.a, one = body->principal.b, other = body->principal.c;
  double moment = moments[0], first = moments[1], second = moments[2];
  if (1 / moments[0] - 1 / moments[1] <= 1 / moments[1] - 1 / moments[2]) {
    axis = body->principal.c, one = body->principal.a, other = body->principal.b;
    moment = moments[2], first = moments[0], second = moments[1];
  }
  double across = (1 / first + 1 / second) / 2, rest = 1 / first - across;
  q = top_turn(q, momentum, axis, moment, across, h / 2);
  if (rest * length(momentum) * h > 1e-15) {
    q = product(q, turn_about(one, along_axis(q, momentum, one) * rest * h / 2));
    q = product(q, turn_about(other, -along_axis(q, momentum, other) * rest * h));
    q = product(q, turn_about(one, along_axis(q, momentum, one) * rest * h / 2));
  }
  return normalised(top_turn(q, momentum, axis, moment, across, h / 2));
}

void rotate_freely(Body *body, double time) {
  Vec3 momentum = body->angular_momentum;
  if (dot(momentum, momentum) == 0 || time == 0) return;
  double turns = length(body->spin) * time / MAX_TURN;
  int divisions = turns < 1 ? 1 : turns > MAX_DIVISIONS ? MAX_DIVISIONS + 1 : 1 + (int)turns;
  Quat q = body->orientation;
  if (body->moments[2] > STIFF * body->moments[0]) {
    divisions = divisions > MAX_DIVISIONS ? MAX_DIVISIONS : divisions;
    for (int i = 0; i < divisions; i++) q = symmetric_top(body, q, momentum, time / divisions);
  } else if (divisions > MAX_DIVISIONS) {
    double size = length(momentum);
    Vec3 axis = scaled(momentum, 1 / size);
    q = normalised(product(turn_about(axis, dot(body->spin, axis) * time), q));
  } else {
    for (int i = 0; i < divisions; i++) q = rkmk4(body, q, momentum, time / divisions);
  }
  body->orientation = q;
  refresh(body);
}
