// The exploded view: fragments of a body move apart, each along the line from the body's foot through its own centre.
import { POSE } from "../data/pieces.js";

/** Moves the poses of the fragments in place; amount 0 leaves all as it is, 1 doubles distances. */
export function explode(pieces, poses, amount) {
  if (amount === 0) return;
  const bodies = new Map();
  pieces.forEach((piece, i) => {
    if (piece.parent < 0 || poses[POSE * i + 3] === 0) return;
    const body = bodies.get(piece.body) ?? { x: 0, z: 0, lowest: Infinity, members: [] };
    bodies.set(piece.body, body);
    body.x += poses[POSE * i];
    body.lowest = Math.min(body.lowest, poses[POSE * i + 1]);
    body.z += poses[POSE * i + 2];
    body.members.push(i);
  });
  // From the lowest centre upwards, so that nothing sinks into the floor.
  for (const { x, z, lowest, members } of bodies.values()) {
    for (const i of members) {
      poses[POSE * i] += amount * (poses[POSE * i] - x / members.length);
      poses[POSE * i + 1] += amount * (poses[POSE * i + 1] - lowest);
      poses[POSE * i + 2] += amount * (poses[POSE * i + 2] - z / members.length);
    }
  }
}
