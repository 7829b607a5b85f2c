// The controls around the stage, and what they say of it.
import { byId, element } from "../dom.js";
import { count, length, mass, speed, time, volume } from "../format.js";

const PLAY = "M4 2.5v11l9-5.5z";
const PAUSE = "M4 3h3v10H4zM9 3h3v10H9z";

const frameNumber = (player) => player.first + Math.round(player.frame);

export const momentText = (player) => `frame ${frameNumber(player)}, ${time(player.time)}`;

function bindTransport(player) {
  const slider = byId("frame");
  const button = byId("play");
  slider.max = player.last;
  const showFrame = () => {
    slider.value = Math.round(player.frame);
    slider.setAttribute("aria-valuetext", momentText(player));
    byId("clock").textContent = `${frameNumber(player)} / ${player.first + player.last} · ${time(player.time)}`;
    byId("viewer").dataset.frame = frameNumber(player);
  };
  const showState = () => {
    button.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    byId("play-icon").setAttribute("d", player.playing ? PAUSE : PLAY);
  };
  player.addEventListener("frame", showFrame);
  player.addEventListener("state", showState);
  slider.addEventListener("input", () => {
    player.pause();
    player.seek(Number(slider.value));
  });
  button.addEventListener("click", () => player.toggle());
  byId("back").addEventListener("click", () => player.step(-1));
  byId("forward").addEventListener("click", () => player.step(1));
  byId("speed").addEventListener("change", (event) => player.setSpeed(Number(event.target.value)));
  for (const control of document.querySelectorAll(".transport :is(button, input, select)"))
    control.disabled = player.count < 2;
  showFrame();
  showState();
}

/** Frames of the fractures that made fragments, ascending, each once; `frameAfter`: the first that shows one. */
function bindFractures(player, fractures) {
  const frames = [
    ...new Set(fractures.filter((f) => f.fragments > 0).map((f) => Math.min(player.last, frameAfter(player, f.time)))),
  ].sort((a, b) => a - b);
  const marks = frames.map((frame) =>
    element("span", { style: `left:${((100 * frame) / Math.max(1, player.last)).toFixed(2)}%` }),
  );
  byId("marks").append(...marks);
  const go = (frame) => {
    if (frame === undefined) return;
    player.pause();
    player.seek(frame);
  };
  const toNext = () => go(frames.find((frame) => frame > player.frame));
  const toPrevious = () => go(frames.findLast((frame) => frame < player.frame));
  byId("next-fracture").addEventListener("click", toNext);
  byId("previous-fracture").addEventListener("click", toPrevious);
  for (const id of ["next-fracture", "previous-fracture"]) byId(id).disabled = frames.length === 0;
  return { toNext, toPrevious };
}

export const frameAfter = (player, seconds) => Math.ceil(seconds * player.rate - 1e-6);

function bindModes(view) {
  const radios = view.modes.map((mode) => {
    const input = element("input", { type: "radio", name: "mode", value: mode.id, disabled: Boolean(mode.missing) });
    input.addEventListener("change", () => view.setMode(mode.id));
    return element(
      "label",
      { title: mode.missing },
      input,
      element("span", {}, mode.name, element("kbd", {}, mode.key)),
    );
  });
  byId("modes").append(...radios);
  const show = () => {
    for (const input of document.getElementsByName("mode")) input.checked = input.value === view.mode.id;
    byId("legend").replaceChildren(view.mode.legend());
    byId("viewer").dataset.mode = view.mode.id;
  };
  view.addEventListener("mode", show);
  show();
}

function bindViewOptions(view) {
  const slider = byId("explode");
  const check = byId("outside");
  slider.addEventListener("input", () => view.setExplode(Number(slider.value)));
  view.addEventListener("explode", () => (slider.value = view.amount));
  check.addEventListener("change", () => view.hideOutside(check.checked));
  view.addEventListener("outside", () => (check.checked = view.outsideHidden));
  byId("fit").addEventListener("click", () => view.frameSelection());
  if (view.stage.floor) byId("stage-scale").textContent = `Grid ${length(view.spacing)}`;
}

const fact = (name, value) => element("div", {}, element("dt", {}, name), element("dd", {}, value));

function bindSelectionCard(view, selection) {
  const card = byId("selection");
  const show = () => {
    const piece = view.selected();
    byId("viewer").dataset.selected = piece?.name ?? "";
    if (!piece)
      return card.replaceChildren(
        element("p", { class: "quiet" }, "Click a piece, or choose one in the table of fragments."),
      );
    const parent = view.pieces[view.indexOf.get(piece.parent)];
    card.replaceChildren(
      element("p", { class: "selected-name" }, piece.name),
      element(
        "dl",
        { class: "facts" },
        fact("Volume", volume(piece.volume)),
        fact("Mass", mass(piece.mass)),
        fact("Generation", count(piece.generation)),
        parent ? fact("Broke from", parent.name) : null,
        parent ? fact("At", time(piece.birth)) : null,
        Number.isFinite(piece.death) ? fact("Broke at", time(piece.death)) : null,
        element("div", {}, element("dt", {}, "Speed now"), element("dd", { id: "selected-speed", "aria-live": "off" })),
      ),
      element("button", { type: "button", onclick: () => selection.set(null) }, "Clear selection"),
    );
    showSpeed();
  };
  const showSpeed = () => {
    const piece = view.selected();
    if (piece) byId("selected-speed").textContent = speed(view.speeds()[piece.index]);
  };
  selection.addEventListener("change", show);
  view.player.addEventListener("frame", showSpeed);
  show();
}

// A click selects, a drag does not.
function bindPicking(view, canvas) {
  let down = null;
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    view.pickAt(event.offsetX, event.offsetY);
  });
  // The wheel scrolls the page until somebody works with the view.
  view.stage.controls.enableZoom = false;
  canvas.addEventListener("focus", () => (view.stage.controls.enableZoom = true));
  canvas.addEventListener("blur", () => (view.stage.controls.enableZoom = false));
}

/** Returns the jumps between fractures, for the keys. */
export function bindControls(view, { player, selection, fractures }) {
  bindTransport(player);
  bindModes(view);
  bindViewOptions(view);
  bindSelectionCard(view, selection);
  bindPicking(view, byId("canvas"));
  return bindFractures(player, fractures);
}
