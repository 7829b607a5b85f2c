// What the stage draws: the merged mesh of all pieces, once as it is, once as numbers to pick from, once flat as its
// shadow; and the floor.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  FloatType,
  LinearFilter,
  Mesh,
  NotEqualStencilFunc,
  PlaneGeometry,
  RGBAFormat,
  ReplaceStencilOp,
  SRGBColorSpace,
  ShaderMaterial,
  Vector2,
  Vector3,
  Vector4,
} from "three";
import { rampBytes } from "./colours.js";
import * as shaders from "./shaders.js";

const ROW = 4 * shaders.TEXELS * shaders.PIECES_PER_ROW;

/** Where the numbers of a piece begin among those of the texture of all pieces. */
export const texelOf = (piece) =>
  Math.floor(piece / shaders.PIECES_PER_ROW) * ROW + (piece % shaders.PIECES_PER_ROW) * 4 * shaders.TEXELS;

export function pieceTexture(count) {
  const rows = Math.max(1, Math.ceil(count / shaders.PIECES_PER_ROW));
  const width = shaders.TEXELS * shaders.PIECES_PER_ROW;
  return new DataTexture(new Float32Array(ROW * rows), width, rows, RGBAFormat, FloatType);
}

function rampTexture(name) {
  const texture = new DataTexture(rampBytes(name), 256, 1, RGBAFormat);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

// Linear colour and roughness of each material of the file.
const materialColours = (materials) =>
  Array.from({ length: shaders.MATERIALS }, (_, i) => {
    const surface = materials[Math.min(i, materials.length - 1)]?.pbrMetallicRoughness ?? {};
    const [r, g, b] = surface.baseColorFactor ?? [0.6, 0.6, 0.6];
    return new Vector4(r, g, b, surface.roughnessFactor ?? 1);
  });

/** Of mergePieces; its groups, runs of faces, are what is drawn. */
export function meshGeometry(mesh) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("key", new BufferAttribute(mesh.keys, 1));
  geometry.setAttribute("shade", new BufferAttribute(mesh.normals, 4, true));
  geometry.setAttribute("damage", new BufferAttribute(mesh.damage, 1));
  geometry.setIndex(new BufferAttribute(mesh.indices, 1));
  return geometry;
}

// Groups are drawn with the materials of a list, so it is one even of one.
function layer(geometry, order, settings) {
  const mesh = new Mesh(geometry, [new ShaderMaterial(settings)]);
  mesh.frustumCulled = false;
  mesh.matrixAutoUpdate = false;
  mesh.renderOrder = order;
  return mesh;
}

export function surfaceLayer(geometry, { texture, materials, damageRange }) {
  const uniforms = {
    pieces: { value: texture },
    materials: { value: materialColours(materials) },
    mode: { value: 0 },
    damageRange: { value: new Vector2(...damageRange) },
    ramps: { value: rampTexture("damage") },
    accent: { value: new Color() },
    up: { value: new Vector3() },
    exposure: { value: 1 },
  };
  const { surfaceVertex: vertexShader, surfaceFragment: fragmentShader } = shaders;
  return layer(geometry, 0, { uniforms, vertexShader, fragmentShader });
}

export function pickLayer(geometry, texture) {
  const { pickVertex: vertexShader, pickFragment: fragmentShader } = shaders;
  return layer(geometry, 0, { uniforms: { pieces: { value: texture } }, vertexShader, fragmentShader });
}

// Shadows of several pieces on one spot darken it once.
const ONCE = { stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc, stencilZPass: ReplaceStencilOp };

export function shadowLayer(geometry, { texture, ground }) {
  const uniforms = {
    pieces: { value: texture },
    ground: { value: ground },
    reach: { value: 1 },
    strength: { value: 0.3 },
  };
  const { shadowVertex: vertexShader, shadowFragment: fragmentShader } = shaders;
  return layer(geometry, 2, { uniforms, vertexShader, fragmentShader, transparent: true, depthWrite: false, ...ONCE });
}

/** A square of side 2 that is to be scaled by its radius. */
export function floorLayer(ground) {
  const uniforms = {
    colour: { value: new Color() },
    spacing: { value: 1 },
    radius: { value: 1 },
    thickness: { value: 1 },
  };
  const { floorVertex: vertexShader, floorFragment: fragmentShader } = shaders;
  const settings = { uniforms, vertexShader, fragmentShader, transparent: true, depthWrite: false };
  const floor = new Mesh(new PlaneGeometry(2, 2).rotateX(-Math.PI / 2), new ShaderMaterial(settings));
  floor.position.y = ground;
  floor.renderOrder = 1;
  return floor;
}

/** Gaps of so few faces are drawn along: a draw call costs more. What does not exist is a point. */
const SMALL_GAP = 3000;

/** Runs of neighbouring parts that are shown: [{ start, count, materialIndex }]. */
export function runsOf(parts, shown) {
  const runs = [];
  for (const part of parts) {
    if (!shown(part)) continue;
    const last = runs.at(-1);
    if (last && part.start - (last.start + last.count) <= SMALL_GAP) last.count = part.start + part.count - last.start;
    else runs.push({ start: part.start, count: part.count, materialIndex: 0 });
  }
  return runs;
}
