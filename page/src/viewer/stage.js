// The picture: renderer, camera, floor, and the merged mesh of all pieces.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DoubleSide,
  FloatType,
  LinearFilter,
  Mesh,
  NotEqualStencilFunc,
  PerspectiveCamera,
  PlaneGeometry,
  RGBAFormat,
  ReplaceStencilOp,
  SRGBColorSpace,
  Scene,
  ShaderMaterial,
  Vector2,
  Vector3,
  Vector4,
  WebGLRenderTarget,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { POSE } from "../data/pieces.js";
import { rampBytes } from "./colours.js";
import * as shaders from "./shaders.js";

const ROW = 4 * shaders.TEXELS * shaders.PIECES_PER_ROW;

// Where the numbers of a piece begin among those of the texture.
const texelOf = (piece) =>
  Math.floor(piece / shaders.PIECES_PER_ROW) * ROW + (piece % shaders.PIECES_PER_ROW) * 4 * shaders.TEXELS;

function pieceTexture(count) {
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
function materialColours(materials) {
  const colours = Array.from({ length: shaders.MATERIALS }, (_, i) => {
    const surface = materials[Math.min(i, materials.length - 1)]?.pbrMetallicRoughness ?? {};
    const [r, g, b] = surface.baseColorFactor ?? [0.6, 0.6, 0.6];
    return new Vector4(r, g, b, surface.roughnessFactor ?? 1);
  });
  return colours;
}

function meshGeometry(mesh) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("key", new BufferAttribute(mesh.keys, 1));
  geometry.setAttribute("shade", new BufferAttribute(mesh.normals, 4, true));
  geometry.setAttribute("damage", new BufferAttribute(mesh.damage, 1));
  geometry.setIndex(new BufferAttribute(mesh.indices, 1));
  return geometry;
}

function drawn(geometry, settings) {
  const mesh = new Mesh(geometry, new ShaderMaterial({ side: DoubleSide, ...settings }));
  mesh.frustumCulled = false;
  mesh.matrixAutoUpdate = false;
  return mesh;
}

// Shadows of several pieces on one spot darken it once.
const ONCE = { stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc, stencilZPass: ReplaceStencilOp };

/** Throws when the browser has no WebGL 2. */
export class Stage extends EventTarget {
  /** `materials`: of the file; `mesh`: mergePieces; `damageRange` [s]; `ground`: its height [m], null: none. */
  constructor(canvas, { materials, count, mesh, damageRange, ground }) {
    super();
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true, powerPreference: "high-performance" });
    this.ratio = Math.min(window.devicePixelRatio, 2);
    this.renderer.setPixelRatio(this.ratio);
    this.scene = new Scene();
    this.scene.background = new Color();
    this.camera = new PerspectiveCamera(35, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.request());
    this.texture = pieceTexture(count);
    this.hidden = mesh.hidden;
    this.buildMesh(mesh, materials, damageRange);
    if (ground !== null) this.buildFloor(ground);
    this.applyTheme();
  }

  buildMesh(mesh, materials, damageRange) {
    this.geometry = meshGeometry(mesh);
    this.uniforms = {
      pieces: { value: this.texture },
      materials: { value: materialColours(materials) },
      mode: { value: 0 },
      damageRange: { value: new Vector2(...damageRange) },
      ramps: { value: rampTexture("damage") },
      accent: { value: new Color() },
      up: { value: new Vector3() },
      exposure: { value: 1 },
    };
    const { surfaceVertex: vertexShader, surfaceFragment: fragmentShader } = shaders;
    this.surface = drawn(this.geometry, { uniforms: this.uniforms, vertexShader, fragmentShader });
    this.scene.add(this.surface);
    this.picking = new Scene();
    this.picking.add(
      drawn(this.geometry, {
        uniforms: { pieces: this.uniforms.pieces },
        vertexShader: shaders.pickVertex,
        fragmentShader: shaders.pickFragment,
      }),
    );
    this.pixel = new WebGLRenderTarget(1, 1);
  }

  buildFloor(ground) {
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.floorUniforms = { colour: { value: new Color() }, spacing: { value: 1 }, radius: { value: 1 } };
    this.floor = drawn(new PlaneGeometry(2, 2).rotateX(-Math.PI / 2), {
      uniforms: this.floorUniforms,
      vertexShader: shaders.floorVertex,
      fragmentShader: shaders.floorFragment,
      transparent: true,
      depthWrite: false,
    });
    this.floor.matrixAutoUpdate = true;
    this.floor.position.y = ground;
    this.floor.renderOrder = 1;
    this.shadowUniforms = {
      pieces: this.uniforms.pieces,
      ground: { value: ground },
      reach: { value: 1 },
      strength: { value: 0.3 },
    };
    this.shadow = drawn(this.geometry, {
      uniforms: this.shadowUniforms,
      vertexShader: shaders.shadowVertex,
      fragmentShader: shaders.shadowFragment,
      transparent: true,
      depthWrite: false,
      ...ONCE,
    });
    this.shadow.renderOrder = 2;
    this.scene.add(this.floor, this.shadow);
  }

  /** Colours of the page's style: it may be light or dark. */
  applyTheme() {
    const style = getComputedStyle(this.canvas);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.scene.background.set(colour("--stage"));
    this.uniforms.accent.value.set(colour("--stage-accent"));
    this.uniforms.exposure.value = Number(colour("--stage-exposure"));
    if (this.floor) this.floorUniforms.colour.value.set(colour("--stage-line"));
    if (this.floor) this.shadowUniforms.strength.value = Number(colour("--stage-shadow"));
    this.request();
  }

  /** Lines of the floor lie `spacing` apart [m]. */
  scaleFloor(centre, radius, spacing) {
    if (!this.floor) return;
    const reach = 8 * radius;
    const snapped = (x) => Math.round(x / (10 * spacing)) * 10 * spacing;
    this.floor.position.x = snapped(centre[0]);
    this.floor.position.z = snapped(centre[2]);
    this.floor.scale.set(1, 1, 1);
    this.floor.geometry.dispose();
    this.floor.geometry = new PlaneGeometry(2 * reach, 2 * reach).rotateX(-Math.PI / 2);
    this.floorUniforms.radius.value = reach;
    this.floorUniforms.spacing.value = spacing;
    this.shadowUniforms.reach.value = 3 * radius;
  }

  /** Poses as posesAt gives them. */
  setPoses(poses) {
    const data = this.texture.image.data;
    for (let i = 0, p = 0; p < poses.length; ++i, p += POSE) {
      const t = texelOf(i);
      for (let k = 0; k < POSE; ++k) data[t + k] = poses[p + k];
    }
    this.texture.needsUpdate = true;
    this.request();
  }

  /** Linear RGB of each piece, shown where the mode is "piece". */
  setPieceColours(colourOf) {
    const data = this.texture.image.data;
    for (let i = 0; texelOf(i) < data.length && i < colourOf.length; ++i) data.set(colourOf[i], texelOf(i) + POSE);
    this.texture.needsUpdate = true;
    this.request();
  }

  /** "material", "piece" (setPieceColours) or "damage". */
  setMode(mode) {
    this.uniforms.mode.value = ["material", "piece", "damage"].indexOf(mode);
    this.request();
  }

  hideOutside(hide) {
    const begin = hide ? this.hidden : 0;
    this.geometry.setDrawRange(begin, this.geometry.index.count - begin);
    this.request();
  }

  /** Null: none. */
  select(piece) {
    const data = this.texture.image.data;
    if (this.selected !== undefined && this.selected !== null) data[texelOf(this.selected) + POSE + 3] = 0;
    if (piece !== null) data[texelOf(piece) + POSE + 3] = 1;
    this.selected = piece;
    this.texture.needsUpdate = true;
    this.request();
  }

  /** Looks at a sphere from the side that the camera is on. */
  lookAt(centre, radius) {
    const direction = this.camera.position.clone().sub(this.controls.target);
    if (direction.lengthSq() === 0) direction.set(0.55, 0.38, 1);
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const distance = (1.08 * radius) / Math.sin(narrow);
    this.controls.target.set(...centre);
    this.camera.position.copy(this.controls.target).add(direction.setLength(distance));
    this.camera.near = distance / 200;
    this.camera.far = distance * 60;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = radius / 20;
    this.controls.maxDistance = 20 * distance;
    this.controls.update();
    this.request();
  }

  /** Turns the camera about its target by angles [rad], and moves it by a factor of its distance. */
  orbit(around, over, factor = 1) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = offset.length() * factor;
    const polar = Math.acos(offset.y / offset.length()) + over;
    const azimuth = Math.atan2(offset.x, offset.z) + around;
    const bounded = Math.min(this.controls.maxPolarAngle - 1e-3, Math.max(1e-3, polar));
    offset.setFromSphericalCoords(length, bounded, azimuth);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.request();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** The piece at a point of the canvas [CSS pixels], or null. */
  pick(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.camera.setViewOffset(width, height, x, y, 1, 1);
    this.renderer.setRenderTarget(this.pixel);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.clear();
    this.renderer.render(this.picking, this.camera);
    const bytes = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.pixel, 0, 0, 1, 1, bytes);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    const number = bytes[0] + 256 * bytes[1] + 65536 * bytes[2];
    return number === 0 ? null : number - 1;
  }

  /** Draws at the browser's next frame, however often it is asked until then. */
  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.requested = false;
    this.camera.updateMatrixWorld();
    this.uniforms.up.value.set(0, 1, 0).transformDirection(this.camera.matrixWorldInverse);
    this.renderer.render(this.scene, this.camera);
    this.dispatchEvent(new Event("drawn"));
  }
}
