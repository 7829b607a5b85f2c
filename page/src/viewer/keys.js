// Keys of the viewer. They work while nothing that takes text or keys of its own has the focus; with the focus outside of
// the viewer only if they are allowed to and the viewer can be seen.
import { byId } from "../dom.js";
import { momentText } from "./controls.js";

const TURN = Math.PI / 24;

const announced = (player, act) => () => {
  act();
  byId("announcement").textContent = momentText(player);
};

function bindings(view, player, { toNext, toPrevious }) {
  const step = (frames) => announced(player, () => player.step(frames));
  const to = (frame) =>
    announced(player, () => {
      player.pause();
      player.seek(frame);
    });
  const mode = (id) => () => {
    const wanted = view.modes.find((m) => m.id === id);
    if (!wanted.missing) view.setMode(id);
    byId("announcement").textContent = wanted.missing ?? `Coloured by ${wanted.name.toLowerCase()}`;
  };
  return {
    " ": () => player.toggle(),
    ArrowLeft: step(-1),
    ArrowRight: step(1),
    "Shift+ArrowLeft": step(-10),
    "Shift+ArrowRight": step(10),
    Home: to(0),
    End: to(player.last),
    "[": announced(player, toPrevious),
    "]": announced(player, toNext),
    ...Object.fromEntries(view.modes.map(({ key, id }) => [key, mode(id)])),
    e: () => view.toggleExplode(),
    h: () => view.hideOutside(!view.outsideHidden),
    f: () => view.frameSelection(),
    a: () => view.stage.orbit(-TURN, 0),
    d: () => view.stage.orbit(TURN, 0),
    w: () => view.stage.orbit(0, -TURN),
    s: () => view.stage.orbit(0, TURN),
    "+": () => view.stage.orbit(0, 0, 0.87),
    "-": () => view.stage.orbit(0, 0, 1.15),
  };
}

// Whether the key belongs to what has the focus: text and sliders, the space bar of buttons, scrolling boxes.
function isTaken(target, key) {
  if (target.matches("select, textarea, input:not([type=checkbox], [type=radio], [type=range])")) return true;
  if (target.matches("input[type=range], input[type=radio]"))
    return key.startsWith("Arrow") || key === "Home" || key === "End";
  if (target.closest("[data-keys]")) return key.startsWith("Arrow") || key === "Home" || key === "End" || key === " ";
  return key === " " && target.matches("button, summary, a, input");
}

function isInView() {
  const { top, bottom } = byId("canvas").getBoundingClientRect();
  return bottom > 0.15 * window.innerHeight && top < 0.85 * window.innerHeight;
}

export function bindKeys(view, player, jumps) {
  const acts = bindings(view, player, jumps);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const inside = byId("viewer").contains(event.target);
    if (!inside && !(byId("keys-everywhere").checked && isInView())) return;
    const named = event.key.startsWith("Arrow") && event.shiftKey ? `Shift+${event.key}` : event.key;
    const act = acts[named];
    if (!act || isTaken(event.target, event.key)) return;
    event.preventDefault();
    act();
  });
}
