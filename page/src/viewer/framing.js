// What the camera looks at first, and how large it is.
import { POSE, posesAt } from "../data/pieces.js";

const PATIENCE = 0.15; // [s] after the last fracture at most: what flies farther is on its own

function boxOf(mesh, glb) {
  const box = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  for (const primitive of mesh?.primitives ?? []) {
    const { min, max } = glb.document.accessors[primitive.attributes.POSITION];
    for (let k = 0; k < 3; ++k) {
      box.low[k] = Math.min(box.low[k], min[k]);
      box.high[k] = Math.max(box.high[k], max[k]);
    }
  }
  return box;
}

/** Radius of each piece about its own origin, its centre of mass [m]. */
export function radiiOf(glb, pieces) {
  return pieces.map((piece) => {
    const { low, high } = boxOf(piece.mesh, glb);
    return Number.isFinite(low[0]) ? Math.hypot(...low.map((x, k) => Math.max(-x, high[k]))) : 0;
  });
}

function sphereAround(points) {
  if (points.length === 0) return { centre: [0, 0, 0], radius: 1 };
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p.at[k] - p.radius)));
  const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p.at[k] + p.radius)));
  const centre = low.map((x, k) => (x + high[k]) / 2);
  const far = (p) => Math.hypot(...p.at.map((x, k) => x - centre[k])) + p.radius;
  return { centre, radius: Math.max(1e-6, ...points.map(far)) };
}

const visible = (pieces, radii, time, wanted) => {
  const poses = posesAt(pieces, time);
  return pieces
    .filter((piece, i) => poses[POSE * i + 3] > 0 && wanted(piece))
    .map(({ index }) => ({ at: [...poses.subarray(POSE * index, POSE * index + 3)], radius: radii[index] }));
};

/**
 * A sphere { centre, radius } around what breaks: the bodies that do, where they begin, and most of their fragments a
 * moment after the first fracture. Without a fracture: all that moves, or all.
 */
export function firstView(pieces, radii, duration) {
  const fragments = pieces.filter((piece) => piece.parent >= 0);
  if (fragments.length === 0) return sphereAround(visible(pieces, radii, 0, () => true));
  const broken = new Set(fragments.map((piece) => piece.body));
  const first = Math.min(...fragments.map((piece) => piece.birth));
  const belongs = (piece) => broken.has(piece.body);
  const whole = visible(pieces, radii, 0, belongs);
  const after = visible(pieces, radii, Math.min(duration, first + PATIENCE), belongs);
  const near = sphereAround(whole);
  const reach = (p) => Math.hypot(...p.at.map((x, k) => x - near.centre[k])) + p.radius;
  // The farthest tenth may leave the picture, and nothing makes the bodies look smaller than a third of it.
  const sorted = after.sort((a, b) => reach(a) - reach(b)).slice(0, Math.ceil(0.9 * after.length));
  return sphereAround([...whole, ...sorted.filter((p) => reach(p) < 3 * near.radius)]);
}

/** 1, 2 or 5 times a power of ten [m], about a tenth of the radius. */
export function gridSpacing(radius) {
  const power = 10 ** Math.floor(Math.log10(radius / 8));
  return power * [5, 2, 1].find((step) => step * power <= radius / 8);
}
