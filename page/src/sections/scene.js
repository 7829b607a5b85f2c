// The scene file as it was run.
import { byId, element } from "../dom.js";
import { tokens } from "../data/scene_text.js";

function lineOf(text) {
  return tokens(text).map(({ kind, text: part }) => element("span", { class: `toml-${kind}` }, part));
}

export function showScene(text) {
  if (!text) {
    byId("scene-echo").append(
      element(
        "p",
        { class: "quiet" },
        "There is no scene.toml beside report.json: the results were not made from a scene file, or it was removed.",
      ),
    );
    return;
  }
  const lines = text.replace(/\n$/, "").split("\n");
  const code = element(
    "code",
    {},
    lines.flatMap((line) => [...lineOf(line), "\n"]),
  );
  byId("scene-echo").append(element("pre", { class: "card scene", tabindex: "0", "aria-label": "Scene file" }, code));
}
