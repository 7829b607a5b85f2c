// What the stage shows: the pieces at the player's moment, in the colours of the mode, exploded or not.
import { damageRange, usualTopSpeed } from "../data/ranges.js";
import { mergePieces } from "../data/merge.js";
import { POSE, posesAt, readPieces, speedsAt } from "../data/pieces.js";
import { explode } from "./explode.js";
import { firstView, gridSpacing, placeOf, spheresOf } from "./framing.js";
import { colourModes, speedColours } from "./modes.js";
import { Stage } from "./stage.js";

const EXPLODED = 0.8;
const EXPLODE_SECONDS = 0.35;

const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** Events: `mode`, `explode` and `outside` when these change. */
export class View extends EventTarget {
  /** `ground`: height of the floor [m], null: none. Throws when there is no WebGL 2. */
  constructor(canvas, glb, { player, selection, ground }) {
    super();
    this.pieces = readPieces(glb);
    this.indexOf = new Map(this.pieces.map((piece) => [piece.id, piece.index]));
    this.spheres = spheresOf(glb, this.pieces);
    this.player = player;
    this.selection = selection;
    this.poses = new Float32Array(POSE * this.pieces.length);
    this.amount = 0;
    this.outsideHidden = false;
    const mesh = mergePieces(glb, this.pieces);
    const range = damageRange(mesh.damage);
    const fastest = usualTopSpeed(this.pieces);
    const materials = glb.document.materials ?? [];
    this.stage = new Stage(canvas, {
      materials,
      count: this.pieces.length,
      mesh,
      damageRange: range ? [range.low, range.high] : [0, 1],
      ground,
    });
    this.speedColour = speedColours(fastest);
    this.modes = colourModes({ materials, pieces: this.pieces, range, fastest });
    this.whole = firstView(this.pieces, this.spheres, player.last / player.rate);
    this.spacing = gridSpacing(this.whole.radius);
    this.stage.scaleFloor(this.whole.centre, this.whole.radius, this.spacing);
    player.addEventListener("frame", () => this.refresh());
    selection.addEventListener("change", () => this.stage.select(this.selected()?.index ?? null));
    this.setMode(fragmentsIn(this.pieces) ? "fragment" : "material");
  }

  selected() {
    return this.pieces[this.indexOf.get(this.selection.id)] ?? null;
  }

  refresh() {
    posesAt(this.pieces, this.player.time, this.poses);
    explode(this.pieces, this.spheres, this.poses, this.amount);
    if (this.mode.id === "speed") this.stage.setPieceColours(this.speedColour(this.speeds()));
    this.stage.setPoses(this.poses);
  }

  /** Of all pieces now [m/s]. */
  speeds() {
    return speedsAt(this.pieces, this.player.time);
  }

  setMode(id) {
    this.mode = this.modes.find((mode) => mode.id === id);
    if (this.mode.colours) this.stage.setPieceColours(this.mode.colours());
    this.stage.setMode(this.mode.stage);
    this.refresh();
    this.dispatchEvent(new Event("mode"));
  }

  hideOutside(hide) {
    this.outsideHidden = hide;
    this.stage.hideOutside(hide);
    this.dispatchEvent(new Event("outside"));
  }

  setExplode(amount) {
    this.amount = amount;
    this.refresh();
    this.dispatchEvent(new Event("explode"));
  }

  /** Apart when together and back. */
  toggleExplode() {
    const from = this.amount;
    const to = from > 0 ? 0 : EXPLODED;
    if (calm()) return this.setExplode(to);
    let begin = null;
    const tick = (now) => {
      begin ??= now;
      const share = Math.min(1, (now - begin) / 1000 / EXPLODE_SECONDS);
      this.setExplode(from + (to - from) * share * share * (3 - 2 * share));
      if (share < 1) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Looks at the selected piece, without one at all that breaks. */
  frameSelection() {
    const piece = this.selected();
    if (!piece) return this.stage.lookAt(this.whole.centre, this.whole.radius * (1 + this.amount));
    const { centre, radius } = this.spheres[piece.index];
    this.stage.lookAt(placeOf(this.poses, piece.index, centre), 1.6 * Math.max(radius, 1e-6));
  }

  pickAt(x, y) {
    const index = this.stage.pick(x, y);
    this.selection.set(index === null ? null : this.pieces[index].id);
  }
}

const fragmentsIn = (pieces) => pieces.some((piece) => piece.parent >= 0);
