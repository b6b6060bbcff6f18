/* The impulses at all contacts of a stone by itself: no vertex goes on into a surface, and friction opposes slip.
 *
 * For each contact, with velocity v after the impulses, its normal part v_n and tangential part v_t, impulse p likewise:
 *
 *     v_n >= target,  p_n >= 0,  p_n (v_n - target) = 0          Signorini; target = -e v_n before, or -gap / h
 *     |p_t| <= mu p_n,  v_t = 0 or p_t = -mu p_n v_t / |v_t|     Coulomb, a disc: no direction is preferred
 *
 * Projected Gauss-Seidel until nothing changes: after a single pass, a stone that lands flat and elastically on eight
 * vertices would leave with three times its energy. Each contact first tries to stick, which a 3 x 3 inverse answers
 * exactly. Where that takes more friction than there is, the normal part is solved, and the tangential part takes a step
 * against the slip and is put back onto the disc (a fixed point of that is Coulomb's law, whatever the step's length).
 *
 * Gauss-Seidel finds in a few passes which contacts stick, which slip and where to, and which do not press, but then
 * creeps: two vertices at the ends of a short edge take hundreds of passes. So every few passes these states are taken as
 * known. The rest is then linear, in the six velocities w of the body:
 *
 *     M w = (P, L) + sum over sticking J' p + sum over slipping J' (n + mu d) p_n
 *     J w = target n (sticking),   n . J w = target (slipping)
 *
 * There are usually more equations than the body has velocities, as more than three points carry it, so that p is not
 * unique. The method of multipliers (Hestenes 1969) does not mind: p = p_before - rho (J w - target n), a few times over.
 *
 * The order of every sum is part of the result: the impulses are the same to the bit on every machine. */
#include "culet_solver.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

#define PASSES 8 /* over all contacts before their states are taken as known */
#define LAST_PASSES                                                                                                    \
  200            /* of the last round, where the states do not settle, as with friction far above 1; and of a
                          * contact alone, whose slip only has to find its direction */
#define ROUNDS 8
#define STALLED                                                                                                        \
  1e-8                  /* Of the largest impulse: a smaller change that passes no longer reduce is two vertices that
                          * push against each other along the edge between them, more and more: it moves nothing. */
#define CLOSING                                                                                                        \
  1e-6                  /* The same where a vertex still closes its gap: the edge is about to tilt, and no impulses can
                          * stop both of its ends along it to the last digit. That comes to 9e-7. */
#define TOLERANCE 1e-10 /* of the largest impulse: the change in a pass below which the impulses have converged */
#define STIFFNESS 1e3   /* rho in units of the mass. Larger: fewer iterations, more rounding. */
#define ITERATIONS 5
#define ATTEMPTS 4
#define SIZE 6 /* the velocities of a body */

/* What a force or a velocity along a line is to the body: along it, and about the centre of mass. */
typedef struct {
  double part[SIZE];
} Lever;

/* One equation of a contact that presses. */
typedef struct {
  int contact;
  Lever out, back; /* what the impulse does; the velocity that it is to bring to `wanted` */
  double wanted, part;
} Bond;

/* A square matrix, its rows exchanged: a lower triangle with ones on its diagonal, times an upper one. */
typedef struct {
  double rows[SIZE][SIZE];
  int order[SIZE];
} Factors;

typedef struct {
  const CuletBody *body;
  Quat orientation;
  Vec3 momentum, angular_momentum;
  Mat3 turning; /* R I^-1 R' */
  CuletPoint *points;
  int count;
  double friction;
  Bond *bonds;           /* three a point */
  Vec3 *tried, *refined; /* an impulse a point */
} Problem;

static Vec3 triple(const double v[3]) { return vec(v[0], v[1], v[2]); }

static void keep(double v[3], Vec3 given) {
  v[0] = given.x;
  v[1] = given.y;
  v[2] = given.z;
}

static double size_of(Vec3 v) { return larger(larger(fabs(v.x), fabs(v.y)), fabs(v.z)); }

/* q v q*: from the stone's axes to the world's. Like `rotated`, in the order of sums of rotation.py. */
static Vec3 to_world(Quat q, Vec3 v) {
  Vec3 u = vec(q.x, q.y, q.z), t = scaled(cross(u, v), 2), across = cross(u, t);
  return vec(v.x + q.w * t.x + across.x, v.y + q.w * t.y + across.y, v.z + q.w * t.z + across.z);
}

static Vec3 through(const double tensor[9], Quat q, Vec3 v) {
  Vec3 inside = to_world((Quat){q.w, -q.x, -q.y, -q.z}, v);
  return to_world(q,
                  vec(dot(triple(tensor), inside), dot(triple(tensor + 3), inside), dot(triple(tensor + 6), inside)));
}

/* A contact's point of the body's velocity. */
static Vec3 velocity_at(Vec3 velocity, Vec3 spin, Vec3 arm) {
  return vec(velocity.x + spin.y * arm.z - spin.z * arm.y, velocity.y + spin.z * arm.x - spin.x * arm.z,
             velocity.z + spin.x * arm.y - spin.y * arm.x);
}

/* P += p, L += r x p. */
static void add_impulses(const Problem *problem, Vec3 *momentum, Vec3 *angular_momentum) {
  Vec3 p = problem->momentum, l = problem->angular_momentum;
  for (int i = 0; i < problem->count; i++) {
    Vec3 r = triple(problem->points[i].arm), j = triple(problem->points[i].impulse);
    p = add(p, j);
    l = vec(l.x + r.y * j.z - r.z * j.y, l.y + r.z * j.x - r.x * j.z, l.z + r.x * j.y - r.y * j.x);
  }
  *momentum = p;
  *angular_momentum = l;
}

/* Whether the contact can hold its vertex where it is: `*impulse` is the one that would. */
static int sticks(const CuletPoint *point, Vec3 before, Vec3 velocity, double friction, Vec3 *impulse) {
  Vec3 n = triple(point->normal);
  const double *m = point->mass; /* xx, yy, zz, xy, xz, yz */
  double ex = velocity.x - point->target * n.x, ey = velocity.y - point->target * n.y,
         ez = velocity.z - point->target * n.z;
  Vec3 after = vec(before.x - (m[0] * ex + m[3] * ey + m[4] * ez), before.y - (m[3] * ex + m[1] * ey + m[5] * ez),
                   before.z - (m[4] * ex + m[5] * ey + m[2] * ez));
  double normal = dot(after, n);
  if (!(normal >= 0)) return 0;
  Vec3 s = vec(after.x - normal * n.x, after.y - normal * n.y, after.z - normal * n.z);
  *impulse = after;
  double limit = friction * normal;
  return dot(s, s) <= limit * limit;
}

static Vec3 slips(const CuletPoint *point, Vec3 before, Vec3 velocity, double friction, double pressed,
                  double leaving) {
  Vec3 n = triple(point->normal);
  double normal = pressed - (leaving - point->target) / point->normal_inverse_mass;
  normal = normal < 0 ? 0 : normal;
  Vec3 after = scaled(n, normal);
  if (!(friction > 0)) return after;
  double step = point->slip_mass, limit = friction * normal;
  double sx = before.x - pressed * n.x - step * (velocity.x - leaving * n.x);
  double sy = before.y - pressed * n.y - step * (velocity.y - leaving * n.y);
  double sz = before.z - pressed * n.z - step * (velocity.z - leaving * n.z);
  double slip = sqrt(sx * sx + sy * sy + sz * sz), part = slip > limit ? limit / slip : 1;
  return vec(after.x + part * sx, after.y + part * sy, after.z + part * sz);
}

/* Improve the contacts' impulses by Gauss-Seidel; whether a pass has left them as they were. */
static int converged(const Problem *problem, int passes, double stalled) {
  double lightness = 1 / problem->body->mass, friction = problem->friction, last = INFINITY;
  Vec3 momentum, angular_momentum;
  add_impulses(problem, &momentum, &angular_momentum);
  Vec3 velocity = scaled(momentum, lightness);
  Vec3 spin = through(problem->body->inverse_inertia, problem->orientation, angular_momentum);
  for (int pass = 0; pass < passes; pass++) {
    double changed = 0, largest = 0;
    for (int i = 0; i < problem->count; i++) {
      CuletPoint *point = &problem->points[i];
      Vec3 arm = triple(point->arm), normal = triple(point->normal), before = triple(point->impulse), after;
      Vec3 u = velocity_at(velocity, spin, arm);
      double leaving = dot(u, normal), pressed = dot(before, normal);
      if (pressed <= 0 && leaving - point->target >= 0) continue; /* not pressed before, and not now */
      if (!(friction > 0 && sticks(point, before, u, friction, &after)))
        after = slips(point, before, u, friction, pressed, leaving);
      Vec3 change = sub(after, before);
      changed = larger(changed, size_of(change));
      largest = larger(largest, size_of(after));
      keep(point->impulse, after);
      velocity = add(velocity, scaled(change, lightness));
      spin = add(spin, times(&problem->turning, cross(arm, change)));
    }
    if (changed <= TOLERANCE * largest || (0.9 * last < changed && changed <= stalled * largest)) return 1;
    last = changed;
  }
  return 0;
}

/* By Gauss with partial pivoting; 0 if the matrix is singular. */
static int factorise(double matrix[SIZE][SIZE], Factors *factors) {
  memcpy(factors->rows, matrix, sizeof factors->rows);
  for (int i = 0; i < SIZE; i++) factors->order[i] = i;
  double (*rows)[SIZE] = factors->rows;
  for (int column = 0; column < SIZE; column++) {
    int pivot = column;
    for (int i = column + 1; i < SIZE; i++)
      if (fabs(rows[i][column]) > fabs(rows[pivot][column])) pivot = i;
    for (int j = 0; j < SIZE; j++) {
      double held = rows[column][j];
      rows[column][j] = rows[pivot][j];
      rows[pivot][j] = held;
    }
    int held = factors->order[column];
    factors->order[column] = factors->order[pivot];
    factors->order[pivot] = held;
    if (!(fabs(rows[column][column]) > 0)) return 0;
    double scale = 1 / rows[column][column];
    for (int i = column + 1; i < SIZE; i++) {
      double factor = rows[i][column] *= scale;
      if (factor != 0)
        for (int j = column + 1; j < SIZE; j++) rows[i][j] -= factor * rows[column][j];
    }
  }
  return 1;
}

/* x with matrix x = right. */
static void solution(const Factors *factors, const double right[SIZE], double x[SIZE]) {
  for (int i = 0; i < SIZE; i++) {
    double value = right[factors->order[i]];
    for (int j = 0; j < i; j++) value -= factors->rows[i][j] * x[j];
    x[i] = value;
  }
  for (int i = SIZE - 1; i >= 0; i--) {
    double value = x[i];
    for (int j = i + 1; j < SIZE; j++) value -= factors->rows[i][j] * x[j];
    x[i] = value / factors->rows[i][i];
  }
}

static Lever lever(Vec3 arm, Vec3 force) {
  Vec3 moment = cross(arm, force);
  return (Lever){{force.x, force.y, force.z, moment.x, moment.y, moment.z}};
}

static int bonds_of(const Problem *problem) {
  static const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double friction = problem->friction;
  int count = 0;
  for (int i = 0; i < problem->count; i++) {
    const CuletPoint *point = &problem->points[i];
    Vec3 arm = triple(point->arm), n = triple(point->normal), impulse = problem->tried[i];
    double normal = dot(impulse, n);
    if (normal <= 0) continue;
    Vec3 s = vec(impulse.x - normal * n.x, impulse.y - normal * n.y, impulse.z - normal * n.z);
    double limit = friction * normal * (1 - 1e-9);
    if (friction == 0 || dot(s, s) >= limit * limit) {
      Vec3 push = vec(impulse.x / normal, impulse.y / normal, impulse.z / normal);
      problem->bonds[count++] = (Bond){i, lever(arm, push), lever(arm, n), point->target, normal};
      continue;
    }
    double parts[3], along[3];
    keep(parts, impulse);
    keep(along, n);
    for (int axis = 0; axis < 3; axis++) {
      Lever both = lever(arm, axes[axis]);
      problem->bonds[count++] = (Bond){i, both, both, point->target * along[axis], parts[axis]};
    }
  }
  return count;
}

/* `refined` becomes the impulses that the states which `tried` shows ask for; 0 if no single answer does. */
static int solved(const Problem *problem) {
  double rho = STIFFNESS * problem->body->mass;
  Bond *bonds = problem->bonds;
  int count = bonds_of(problem);
  for (int i = 0; i < problem->count; i++) problem->refined[i] = ZERO;
  if (count == 0) return 1;

  double matrix[SIZE][SIZE] = {{0}}, momenta[SIZE], right[SIZE] = {0};
  keep(momenta, problem->momentum);
  keep(momenta + 3, problem->angular_momentum);
  for (int k = 0; k < count; k++)
    for (int i = 0; i < SIZE; i++) {
      double stiff = rho * bonds[k].out.part[i];
      right[i] += stiff * bonds[k].wanted;
      for (int j = 0; j < SIZE; j++) matrix[i][j] += stiff * bonds[k].back.part[j];
    }
  for (int i = 0; i < 3; i++) {
    double row[3];
    keep(row, through(problem->body->inertia, problem->orientation, vec(i == 0, i == 1, i == 2)));
    matrix[i][i] = problem->body->mass + matrix[i][i];
    for (int j = 0; j < 3; j++) matrix[3 + i][3 + j] = row[j] + matrix[3 + i][3 + j];
  }
  Factors factors;
  if (!factorise(matrix, &factors)) return 0;
  for (int i = 0; i < SIZE; i++) right[i] = momenta[i] + right[i];

  for (int iteration = 0; iteration < ITERATIONS; iteration++) {
    double pushed[SIZE] = {0}, w[SIZE];
    for (int k = 0; k < count; k++)
      for (int i = 0; i < SIZE; i++) pushed[i] += bonds[k].part * bonds[k].out.part[i];
    for (int i = 0; i < SIZE; i++) pushed[i] = right[i] + pushed[i];
    solution(&factors, pushed, w);
    for (int k = 0; k < count; k++) {
      double leaving = 0;
      for (int i = 0; i < SIZE; i++) leaving += bonds[k].back.part[i] * w[i];
      bonds[k].part -= rho * (leaving - bonds[k].wanted);
    }
  }
  for (int k = 0; k < count; k++) {
    Vec3 *impulse = &problem->refined[bonds[k].contact];
    *impulse = add(*impulse, scaled(triple(bonds[k].out.part), bonds[k].part));
  }
  return 1;
}

/* The impulse if it is one that the contact can give; else with less friction, or none at all. */
static Vec3 on_cone(const CuletPoint *point, Vec3 impulse, double friction) {
  Vec3 n = triple(point->normal);
  double normal = dot(impulse, n);
  if (normal <= 0) return ZERO;
  Vec3 s = vec(impulse.x - normal * n.x, impulse.y - normal * n.y, impulse.z - normal * n.z);
  double slip = length(s), limit = friction * normal;
  if (slip <= limit * (1 + 1e-9)) return impulse;
  double part = limit / slip;
  return add(scaled(n, normal), scaled(s, part));
}

/* Replace the impulses by those that the states which they show ask for.
 *
 * A contact that would have to pull is let go of, one that would need more friction than there is slips, and the rest is
 * solved again; after a few attempts the impulses are what was found, put back onto their cones. */
static void refine(const Problem *problem) {
  for (int i = 0; i < problem->count; i++) problem->tried[i] = triple(problem->points[i].impulse);
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    if (!solved(problem)) return;
    int settled = 1;
    for (int i = 0; i < problem->count; i++) {
      Vec3 found = problem->refined[i], put = on_cone(&problem->points[i], found, problem->friction);
      settled &= put.x == found.x && put.y == found.y && put.z == found.z;
      problem->tried[i] = put;
    }
    if (settled) break;
  }
  for (int i = 0; i < problem->count; i++) keep(problem->points[i].impulse, problem->tried[i]);
}

/* Whether the contacts' states came to agree. */
static int agree(const Problem *problem) {
  double stalled = STALLED;
  for (int i = 0; i < problem->count; i++) {
    if (problem->points[i].target < 0) stalled = CLOSING;
    keep(problem->points[i].impulse, ZERO);
  }
  for (int round = 0; round < ROUNDS; round++) {
    int last = round == ROUNDS - 1;
    int passes = last || problem->count <= 1 ? LAST_PASSES : PASSES;
    if (converged(problem, passes, round > 0 ? stalled : 0)) return 1;
    if (!last) refine(problem);
  }
  return 0;
}

/* Where friction far above 1 keeps the contacts from agreeing (Painlevé): a further push along the normals. Without
 * friction the problem is convex and has an answer, and more pressure leaves the impulses within the disc. */
static void finish_without_friction(Problem *problem) {
  for (int i = 0; i < problem->count; i++) problem->refined[i] = triple(problem->points[i].impulse);
  Vec3 *so_far = problem->refined;
  problem->refined = so_far + problem->count;
  add_impulses(problem, &problem->momentum, &problem->angular_momentum);
  problem->friction = 0;
  agree(problem);
  add_impulses(problem, &problem->momentum, &problem->angular_momentum);
  for (int i = 0; i < problem->count; i++)
    keep(problem->points[i].impulse, add(triple(problem->points[i].impulse), so_far[i]));
}

int32_t culet_stone_impulses(const CuletBody *body, CuletMotion *motion, int32_t count, CuletPoint *points,
                             double friction) {
  size_t room = (size_t)(count > 0 ? count : 1);
  Bond *bonds = malloc(3 * room * sizeof(Bond));
  Vec3 *impulses = malloc(3 * room * sizeof(Vec3));
  if (!bonds || !impulses) {
    free(bonds);
    free(impulses);
    return -1;
  }
  const double *q = motion->orientation;
  Problem problem = {.body = body,
                     .orientation = {q[0], q[1], q[2], q[3]},
                     .momentum = triple(motion->momentum),
                     .angular_momentum = triple(motion->angular_momentum),
                     .points = points,
                     .count = count,
                     .friction = friction,
                     .bonds = bonds,
                     .tried = impulses,
                     .refined = impulses + room};
  Vec3 x = through(body->inverse_inertia, problem.orientation, vec(1, 0, 0));
  Vec3 y = through(body->inverse_inertia, problem.orientation, vec(0, 1, 0));
  Vec3 z = through(body->inverse_inertia, problem.orientation, vec(0, 0, 1));
  problem.turning = (Mat3){x, vec(x.y, y.y, y.z), vec(x.z, y.z, z.z)};
  if (!agree(&problem) && friction > 0)
    finish_without_friction(&problem);
  else
    add_impulses(&problem, &problem.momentum, &problem.angular_momentum);
  keep(motion->momentum, problem.momentum);
  keep(motion->angular_momentum, problem.angular_momentum);
  free(bonds);
  free(impulses);
  return 0;
}
