// The pieces of a run: bodies of the scene and fragments, in the order of fragments.glb.
import { Moment, readTracks, speedAt, writePose } from "./tracks.js";

/** Numbers that `writePose` writes for a piece. */
export const POSE = 8;

/**
 * `[{ index, id, name, body, parent, generation, birth, death, volume, mass, mesh, track }]`; `parent` -1: a body of
 * the scene; `death` Infinity: exists at the end; `mesh`: of the file, null when it has no faces.
 */
export function readPieces(glb) {
  const tracks = readTracks(glb);
  return glb.document.nodes.map((node, index) => {
    const extras = node.extras ?? {};
    return {
      index,
      id: extras.id ?? index,
      name: node.name ?? `piece ${index}`,
      body: extras.body ?? node.name,
      parent: extras.parent ?? -1,
      generation: extras.generation ?? 0,
      birth: extras.birth_time ?? 0,
      death: extras.death_time ?? Infinity,
      volume: extras.volume ?? 0,
      mass: extras.mass ?? 0,
      mesh: node.mesh === undefined ? null : glb.document.meshes[node.mesh],
      track: tracks[index],
    };
  });
}

/** Poses of all pieces, POSE numbers each: x, y, z, visible, quaternion. */
export function posesAt(pieces, time, out = new Float32Array(POSE * pieces.length)) {
  const moment = new Moment(time);
  pieces.forEach((piece, i) => writePose(piece.track, moment, out, POSE * i));
  return out;
}

/** Speeds of all pieces [m/s]. */
export function speedsAt(pieces, time, out = new Float32Array(pieces.length)) {
  const moment = new Moment(time);
  pieces.forEach((piece, i) => (out[i] = speedAt(piece.track, moment)));
  return out;
}
