/** Vectors of the world. */

export type Vector = readonly [number, number, number];
/** A unit quaternion w, x, y, z. */
export type Quaternion = readonly [number, number, number, number];

export function plus(a: Vector, b: Vector): Vector {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function times(factor: number, v: Vector): Vector {
  return [factor * v[0], factor * v[1], factor * v[2]];
}

export function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function unit(v: Vector): Vector {
  const length = Math.hypot(...v) || 1;
  return times(1 / length, v);
}

/** A vector turned by a rotation: v + 2 w (q x v) + 2 q x (q x v). */
export function turned([w, ...q]: Quaternion, v: Vector): Vector {
  const once = cross(q, v);
  return plus(v, plus(times(2 * w, once), times(2, cross(q, once))));
}

/** The same, back. */
export function turnedBack([w, x, y, z]: Quaternion, v: Vector): Vector {
  return turned([w, -x, -y, -z], v);
}
