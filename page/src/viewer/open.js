// The viewer, or the reason why there is none.
import { byId, element } from "../dom.js";
import { parseGlb } from "../data/glb.js";
import { groundHeight } from "../data/scene_text.js";
import { memory } from "../format.js";
import { bindControls } from "./controls.js";
import { bindKeys } from "./keys.js";
import { View } from "./view.js";

/** Shown first where nothing plays by itself: fragments that begin to part [s after the first fracture]. */
const STILL = 0.1;

export function say(...text) {
  byId("stage-message").replaceChildren(...text);
  byId("stage-message").hidden = text.length === 0;
}

function saySorry(...text) {
  byId("viewer").classList.add("no-view");
  for (const control of byId("viewer").querySelectorAll("button, input, select")) control.disabled = true;
  say(element("p", {}, ...text));
  return null;
}

const ELSEWHERE =
  "Open fragments.glb, which lies beside this page, in Blender (File, Import, glTF 2.0) or any other viewer of glTF.";

function firstFrame(player, fractures) {
  const first = fractures.find((f) => f.fragments > 0);
  return first ? Math.ceil((first.time + STILL) * player.rate) : 0;
}

/** Returns the view, or null when there is nothing to show or nothing to show it with. */
export function openViewer({ size, bytes }, { scene, fractures, player, selection }) {
  if (size === 0) return saySorry("There is no fragments.glb beside report.json: the run wrote none.");
  if (!bytes) return saySorry(`The geometry, ${memory(size)}, is too much for a page. ${ELSEWHERE}`);
  let view;
  try {
    view = new View(byId("canvas"), parseGlb(bytes), { player, selection, ground: groundHeight(scene) });
  } catch (error) {
    const reason = /WebGL/.test(error.message) ? "This browser shows no WebGL 2" : error.message;
    return saySorry(`${reason}. Everything else on this page works. ${ELSEWHERE}`);
  }
  const jumps = bindControls(view, { player, selection, fractures });
  bindKeys(view, player, jumps);
  begin(view, player, fractures);
  return view;
}

function begin(view, player, fractures) {
  const { stage } = view;
  new ResizeObserver(() => stage.resize()).observe(byId("canvas").parentElement);
  stage.resize();
  view.frameSelection();
  for (const query of ["(prefers-color-scheme: dark)", "(prefers-contrast: more)"])
    matchMedia(query).addEventListener("change", () => stage.applyTheme());
  byId("canvas").addEventListener("webglcontextlost", () =>
    say("The browser took the graphics away; reload the page."),
  );
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (calm) player.seek(firstFrame(player, fractures));
  stage.addEventListener(
    "drawn",
    () => {
      say();
      performance.mark("sunder-first-frame");
      byId("viewer").dataset.ready = "";
      if (!calm) player.play();
    },
    { once: true },
  );
  view.refresh();
}
