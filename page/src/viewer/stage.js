// The picture: renderer, camera, and when it is drawn how finely.
import { Color, DoubleSide, FrontSide, PerspectiveCamera, Scene, WebGLRenderTarget, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { POSE } from "../data/pieces.js";
import { drawsInSoftware } from "./graphics.js";
import {
  floorLayer,
  meshGeometry,
  pickLayer,
  pieceTexture,
  runsOf,
  shadowLayer,
  surfaceLayer,
  texelOf,
} from "./layers.js";

const MODES = ["material", "piece", "damage"];

/** Most pixels of a picture; a graphics card fills more, and software fewer, than anybody sees. */
const MOST_PIXELS = { card: 12e6, software: 4e6, softwareMoving: 1e6 };
const FINEST = 2; // pixels of the picture per pixel of the page
/** What moves is drawn quickly in software; so long after the last change it is drawn well [ms]. */
const REST = 350;

/** Event `drawn`. Its canvas has data-still while it shows the newest state as well as it can be drawn. */
export class Stage extends EventTarget {
  /**
   * `materials`: of the file; `count` of the pieces; `mesh`: mergePieces; `damageRange` [s]; `ground`: its height [m], null:
   * none. Throws when the browser has no WebGL 2.
   */
  constructor(canvas, { materials, count, mesh, damageRange, ground }) {
    super();
    this.canvas = canvas;
    this.slow = drawsInSoftware();
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.slow, stencil: true });
    // The check waits for the compiler; a program that does not compile is named in the console in any case.
    this.renderer.debug.checkShaderErrors = false;
    this.scene = new Scene();
    this.scene.background = new Color();
    this.camera = new PerspectiveCamera(35, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.request());
    this.texture = pieceTexture(count);
    this.parts = mesh.parts;
    this.outsideHidden = false;
    this.selected = null;
    this.geometry = meshGeometry(mesh);
    this.surface = surfaceLayer(this.geometry, { texture: this.texture, materials, damageRange });
    this.scene.add(this.surface);
    this.picking = new Scene().add(pickLayer(this.geometry, this.texture));
    this.pixel = new WebGLRenderTarget(1, 1);
    if (ground !== null) this.addFloor(ground);
    this.applyTheme();
  }

  addFloor(ground) {
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.floor = floorLayer(ground);
    this.shadow = shadowLayer(this.geometry, { texture: this.texture, ground });
    this.scene.add(this.floor, this.shadow);
  }

  uniforms(layer) {
    return [layer.material].flat()[0].uniforms;
  }

  /** Colours of the page's style: it may be light or dark. */
  applyTheme() {
    const style = getComputedStyle(this.canvas);
    const value = (name) => style.getPropertyValue(name).trim();
    this.scene.background.set(value("--stage"));
    this.uniforms(this.surface).accent.value.set(value("--stage-accent"));
    this.uniforms(this.surface).exposure.value = Number(value("--stage-exposure"));
    if (this.floor) this.uniforms(this.floor).colour.value.set(value("--stage-line"));
    if (this.floor) this.uniforms(this.shadow).strength.value = Number(value("--stage-shadow"));
    this.request();
  }

  /** For a scene of a size about a centre; lines lie `spacing` apart [m]. */
  scaleFloor(centre, radius, spacing) {
    if (!this.floor) return;
    const snapped = (x) => Math.round(x / (10 * spacing)) * 10 * spacing;
    this.floor.position.x = snapped(centre[0]);
    this.floor.position.z = snapped(centre[2]);
    this.floor.scale.setScalar(8 * radius);
    this.uniforms(this.floor).radius.value = 8 * radius;
    this.uniforms(this.floor).spacing.value = spacing;
    this.uniforms(this.shadow).reach.value = 3 * radius;
  }

  /** Poses as posesAt gives them. */
  setPoses(poses) {
    const { data } = this.texture.image;
    for (let i = 0, p = 0; p < poses.length; ++i, p += POSE) {
      const t = texelOf(i);
      for (let k = 0; k < POSE; ++k) data[t + k] = poses[p + k];
    }
    this.chooseRuns();
    this.changed();
  }

  // Only pieces that exist now are drawn.
  chooseRuns() {
    const { data } = this.texture.image;
    const hidden = ({ brokenOutside }) => brokenOutside && this.outsideHidden;
    this.geometry.groups = runsOf(this.parts, (part) => data[texelOf(part.piece) + 3] > 0 && !hidden(part));
  }

  changed() {
    this.texture.needsUpdate = true;
    this.request();
  }

  /** Linear RGB of each piece, shown where the mode is "piece". */
  setPieceColours(colours) {
    const { data } = this.texture.image;
    colours.forEach((colour, i) => data.set(colour, texelOf(i) + POSE));
    this.changed();
  }

  /** "material", "piece" (setPieceColours) or "damage". */
  setMode(mode) {
    this.uniforms(this.surface).mode.value = MODES.indexOf(mode);
    this.request();
  }

  hideOutside(hide) {
    this.outsideHidden = hide;
    // Without their outsides one looks into pieces from behind.
    this.surface.material[0].side = hide ? DoubleSide : FrontSide;
    this.surface.material[0].needsUpdate = true;
    this.chooseRuns();
    this.request();
  }

  /** Null: none. */
  select(piece) {
    const { data } = this.texture.image;
    if (this.selected !== null) data[texelOf(this.selected) + POSE + 3] = 0;
    if (piece !== null) data[texelOf(piece) + POSE + 3] = 1;
    this.selected = piece;
    this.changed();
  }

  /** Looks at a sphere from the side that the camera is on. */
  lookAt(centre, radius) {
    const direction = this.camera.position.clone().sub(this.controls.target);
    if (direction.lengthSq() === 0) direction.set(0.5, 0.32, 1);
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const distance = (1.05 * radius) / Math.sin(narrow);
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
    const polar = Math.acos(offset.y / offset.length()) + over;
    const azimuth = Math.atan2(offset.x, offset.z) + around;
    const bounded = Math.min(this.controls.maxPolarAngle - 1e-3, Math.max(1e-3, polar));
    offset.setFromSphericalCoords(offset.length() * factor, bounded, azimuth);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.request();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.size = [width, height];
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  /** The piece at a point of the canvas [CSS pixels], or null. */
  pick(x, y) {
    this.camera.setViewOffset(...this.size, x, y, 1, 1);
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

  /** Draws at the browser's next frame, however often it is asked until then; in software once more, better, at rest. */
  request() {
    delete this.canvas.dataset.still;
    this.schedule(!this.slow);
    clearTimeout(this.rest);
    if (this.slow) this.rest = setTimeout(() => this.schedule(true), REST);
  }

  schedule(fine) {
    this.fine = fine;
    if (!this.requested) requestAnimationFrame(() => this.draw());
    this.requested = true;
  }

  setFineness(fine) {
    const most = this.slow ? (fine ? MOST_PIXELS.software : MOST_PIXELS.softwareMoving) : MOST_PIXELS.card;
    const wanted = this.slow ? (fine ? FINEST : 1) : Math.min(window.devicePixelRatio, FINEST);
    const ratio = Math.min(wanted, Math.sqrt(most / (this.size[0] * this.size[1])));
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    if (!this.floor) return;
    this.shadow.visible = fine;
    this.uniforms(this.floor).thickness.value = 1.2 * ratio;
  }

  draw() {
    this.requested = false;
    if (!this.size) return;
    this.setFineness(this.fine);
    this.camera.updateMatrixWorld();
    this.uniforms(this.surface).up.value.set(0, 1, 0).transformDirection(this.camera.matrixWorldInverse);
    this.renderer.render(this.scene, this.camera);
    if (this.fine) this.canvas.dataset.still = "";
    this.dispatchEvent(new Event("drawn"));
  }
}
