// Where pieces are and how large, and what the camera looks at first.
import { POSE, posesAt } from "../data/pieces.js";

/** Pieces are looked for so long after the first fracture [s], and so far away in radii of what breaks. */
const PATIENCE = 0.1;
const REACH = 2;

function boundsOf(mesh, glb) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const primitive of mesh?.primitives ?? []) {
    const { min, max } = glb.document.accessors[primitive.attributes.POSITION];
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], min[k]);
      high[k] = Math.max(high[k], max[k]);
    }
  }
  if (!Number.isFinite(low[0])) return { centre: [0, 0, 0], radius: 0 };
  return { centre: low.map((x, k) => (x + high[k]) / 2), radius: Math.hypot(...low.map((x, k) => high[k] - x)) / 2 };
}

/** Of each piece in its own frame: { centre, radius } of a sphere around its bounding box [m]. */
export const spheresOf = (glb, pieces) => pieces.map((piece) => boundsOf(piece.mesh, glb));

/** Where the centre of piece `i` is when it has its pose. */
export function placeOf(poses, i, [x, y, z]) {
  const p = POSE * i;
  const [qx, qy, qz, qw] = poses.subarray(p + 4, p + 8);
  // v + 2 q x (q x v + w v)
  const tx = qy * z - qz * y + qw * x;
  const ty = qz * x - qx * z + qw * y;
  const tz = qx * y - qy * x + qw * z;
  return [
    poses[p] + x + 2 * (qy * tz - qz * ty),
    poses[p + 1] + y + 2 * (qz * tx - qx * tz),
    poses[p + 2] + z + 2 * (qx * ty - qy * tx),
  ];
}

function sphereAround(spheres) {
  if (spheres.length === 0) return { centre: [0, 0, 0], radius: 1 };
  const extreme = (side, k) => spheres.map((s) => s.centre[k] + side * s.radius);
  const low = [0, 1, 2].map((k) => extreme(-1, k).reduce((a, b) => Math.min(a, b)));
  const high = [0, 1, 2].map((k) => extreme(1, k).reduce((a, b) => Math.max(a, b)));
  const centre = low.map((x, k) => (x + high[k]) / 2);
  const reach = spheres.map((s) => Math.hypot(...s.centre.map((x, k) => x - centre[k])) + s.radius);
  return { centre, radius: reach.reduce((a, b) => Math.max(a, b), 1e-6) };
}

function existing(pieces, spheres, time, wanted) {
  const poses = posesAt(pieces, time);
  return pieces
    .filter((piece, i) => poses[POSE * i + 3] > 0 && wanted(piece))
    .map(({ index }) => ({ centre: placeOf(poses, index, spheres[index].centre), radius: spheres[index].radius }));
}

/**
 * A sphere { centre, radius } around what breaks: the bodies that do, where they begin, and most of their fragments a
 * moment after the first fracture. Without a fracture: around all.
 */
export function firstView(pieces, spheres, duration) {
  const fragments = pieces.filter((piece) => piece.parent >= 0);
  if (fragments.length === 0) return sphereAround(existing(pieces, spheres, 0, () => true));
  const broken = new Set(fragments.map((piece) => piece.body));
  const first = fragments.reduce((earliest, piece) => Math.min(earliest, piece.birth), Infinity);
  const belongs = (piece) => broken.has(piece.body);
  const whole = existing(pieces, spheres, 0, belongs);
  const after = existing(pieces, spheres, Math.min(duration, first + PATIENCE), belongs);
  const near = sphereAround(whole);
  const reach = (s) => Math.hypot(...s.centre.map((x, k) => x - near.centre[k])) + s.radius;
  // The farthest tenth may leave the picture, and nothing makes what breaks look small.
  const sorted = after.sort((a, b) => reach(a) - reach(b)).slice(0, Math.ceil(0.9 * after.length));
  return sphereAround([...whole, ...sorted.filter((s) => reach(s) < REACH * near.radius)]);
}

/** 1, 2 or 5 times a power of ten [m], at most an eighth of the radius. */
export function gridSpacing(radius) {
  const power = 10 ** Math.floor(Math.log10(radius / 8));
  return power * [5, 2, 1].find((step) => step * power <= radius / 8);
}
