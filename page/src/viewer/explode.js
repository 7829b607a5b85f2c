// The exploded view: fragments of a body move apart, each along the line from the body's foot through its own centre.
import { POSE } from "../data/pieces.js";
import { placeOf } from "./framing.js";

/**
 * Moves the poses of the fragments in place; amount 0 leaves all as it is, 1 doubles distances. `spheres`: spheresOf.
 */
export function explode(pieces, spheres, poses, amount) {
  if (amount === 0) return;
  const bodies = new Map();
  pieces.forEach((piece, i) => {
    if (piece.parent < 0 || poses[POSE * i + 3] === 0) return;
    const body = bodies.get(piece.body) ?? { x: 0, z: 0, lowest: Infinity, members: [] };
    bodies.set(piece.body, body);
    const place = placeOf(poses, i, spheres[i].centre);
    body.x += place[0];
    body.lowest = Math.min(body.lowest, place[1]);
    body.z += place[2];
    body.members.push({ i, place });
  });
  // From the lowest centre upwards, so that nothing sinks into the floor.
  for (const { x, z, lowest, members } of bodies.values()) {
    for (const { i, place } of members) {
      poses[POSE * i] += amount * (place[0] - x / members.length);
      poses[POSE * i + 1] += amount * (place[1] - lowest);
      poses[POSE * i + 2] += amount * (place[2] - z / members.length);
    }
  }
}
