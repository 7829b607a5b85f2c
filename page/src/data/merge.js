// One mesh of all pieces, so that a frame is one draw call however many fragments there are. Each vertex knows its
// piece; where pieces are is looked up by the graphics card (viewer/shaders.js).

/** Outside faces whose normals differ by more than this from their mean at a vertex are shaded flat there. */
const CREASE = Math.cos((35 * Math.PI) / 180);
const NO_TIME = -1;

/** A vertex key holds piece, material and whether its face is on a crack. */
export const keyOf = (piece, material, inside) => ((piece << 12) | (material << 1) | (inside ? 1 : 0)) >>> 0;

const isInside = (glb, primitive) => glb.document.materials?.[primitive.material]?.name?.endsWith("_inside") ?? false;

// Order of the faces: what is hidden together lies together.
const BROKEN_OUTSIDE = 0;
const WHOLE_OUTSIDE = 1;
const INSIDE = 2;

function surfacesOf(glb, pieces) {
  const surfaces = [];
  for (const piece of pieces) {
    const primitives = piece.mesh?.primitives ?? [];
    const broken = primitives.some((p) => isInside(glb, p));
    for (const primitive of primitives) {
      const inside = isInside(glb, primitive);
      const positions = glb.values(primitive.attributes.POSITION);
      const kind = inside ? INSIDE : broken ? BROKEN_OUTSIDE : WHOLE_OUTSIDE;
      const corners = primitive.indices === undefined ? positions.length / 3 : glb.values(primitive.indices).length;
      surfaces.push({ piece: piece.index, primitive, kind, inside, positions, corners });
    }
  }
  return surfaces;
}

class Merger {
  constructor(glb, surfaces) {
    const total = (what) => surfaces.reduce((sum, surface) => sum + what(surface), 0);
    const vertices = total((s) => Math.min(s.positions.length / 3, s.corners));
    this.glb = glb;
    this.positions = new Float32Array(3 * vertices);
    this.keys = new Uint32Array(vertices);
    this.normals = new Int8Array(4 * vertices);
    this.damage = new Float32Array(vertices).fill(NO_TIME);
    this.indices = new Uint32Array(total((s) => s.corners));
    this.vertices = 0;
    const largest = surfaces.reduce((most, s) => Math.max(most, s.positions.length / 3), 0);
    this.mergedOf = new Int32Array(largest).fill(-1);
  }

  /** Appends the surface's vertices that its faces use, and its faces from index `at` on. */
  add(surface, at) {
    const { primitive, positions } = surface;
    const given = primitive.indices === undefined ? null : this.glb.values(primitive.indices);
    const normals = this.optional(primitive.attributes.NORMAL);
    const damage = this.optional(primitive.attributes._DAMAGE_TIME);
    const key = keyOf(surface.piece, primitive.material ?? 0, surface.inside);
    const first = this.vertices;
    for (let i = 0; i < surface.corners; ++i) {
      const v = given ? given[i] : i;
      let merged = this.mergedOf[v];
      if (merged < first) {
        merged = this.mergedOf[v] = this.vertices++;
        for (let k = 0; k < 3; ++k) this.positions[3 * merged + k] = positions[3 * v + k];
        this.keys[merged] = key;
        if (damage) this.damage[merged] = damage[v];
        if (normals) this.setNormal(merged, normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
      }
      this.indices[at + i] = merged;
    }
    if (!normals && !surface.inside) this.smooth(first, at, surface.corners);
  }

  optional(accessor) {
    return accessor === undefined ? null : this.glb.values(accessor);
  }

  setNormal(vertex, x, y, z) {
    this.normals[4 * vertex] = 127 * x;
    this.normals[4 * vertex + 1] = 127 * y;
    this.normals[4 * vertex + 2] = 127 * z;
    this.normals[4 * vertex + 3] = 127;
  }

  /** Vertex normals from the faces around them, weight 0 (flat) at creases. Crack faces stay flat everywhere. */
  smooth(first, at, corners) {
    const sums = new Float32Array(3 * (this.vertices - first));
    const faces = new Float32Array(corners);
    const p = this.positions;
    for (let i = 0; i < corners; i += 3) {
      const a = 3 * this.indices[at + i];
      const b = 3 * this.indices[at + i + 1];
      const c = 3 * this.indices[at + i + 2];
      const ux = p[b] - p[a];
      const uy = p[b + 1] - p[a + 1];
      const uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a];
      const vy = p[c + 1] - p[a + 1];
      const vz = p[c + 2] - p[a + 2];
      // No arrays here: this loop runs over every face of the run.
      const nx = uy * vz - uz * vy;
      const ny = uz * vx - ux * vz;
      const nz = ux * vy - uy * vx;
      const length = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
      faces[i] = nx / length;
      faces[i + 1] = ny / length;
      faces[i + 2] = nz / length;
      for (let corner = 0; corner < 3; ++corner) {
        const s = 3 * (this.indices[at + i + corner] - first);
        sums[s] += nx;
        sums[s + 1] += ny;
        sums[s + 2] += nz;
      }
    }
    for (let i = 0; i < sums.length; i += 3) {
      const length = Math.sqrt(sums[i] * sums[i] + sums[i + 1] * sums[i + 1] + sums[i + 2] * sums[i + 2]) || 1;
      for (let k = 0; k < 3; ++k) sums[i + k] /= length;
      this.setNormal(first + i / 3, sums[i], sums[i + 1], sums[i + 2]);
    }
    for (let i = 0; i < corners; ++i) {
      const vertex = this.indices[at + i];
      const s = 3 * (vertex - first);
      const f = i - (i % 3);
      if (sums[s] * faces[f] + sums[s + 1] * faces[f + 1] + sums[s + 2] * faces[f + 2] < CREASE)
        this.normals[4 * vertex + 3] = 0;
    }
  }
}

/**
 * `positions` (3 a vertex, in the frame of the piece), `keys` (keyOf), `normals` (signed bytes x, y, z and weight; weight
 * 0: flat), `damage` [s] (-1: unknown), `indices`, `parts` [{ piece, brokenOutside, start, count }]: runs of the indices in their order.
 */
export function mergePieces(glb, pieces) {
  const surfaces = surfacesOf(glb, pieces);
  const merger = new Merger(glb, surfaces);
  const ends = [0, 0, 0];
  for (const surface of surfaces) ends[surface.kind] += surface.corners;
  const next = [0, ends[0], ends[0] + ends[1]];
  const parts = surfaces.map((surface) => {
    const start = next[surface.kind];
    merger.add(surface, start);
    next[surface.kind] += surface.corners;
    return { piece: surface.piece, brokenOutside: surface.kind === BROKEN_OUTSIDE, start, count: surface.corners };
  });
  const count = merger.vertices;
  return {
    positions: merger.positions.subarray(0, 3 * count),
    keys: merger.keys.subarray(0, count),
    normals: merger.normals.subarray(0, 4 * count),
    damage: merger.damage.subarray(0, count),
    indices: merger.indices,
    parts: parts.sort((a, b) => a.start - b.start),
  };
}
