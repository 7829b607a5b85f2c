// What colours mean: for each way of colouring what the stage shows and what the legend says.
import { element } from "../dom.js";
import { counted, speed as speedText, time as timeText } from "../format.js";
import { fragmentColour, generationColour, generationCss, lastGeneration, rampCss, rampLinear } from "./colours.js";

const swatch = (colour, text) =>
  element("li", {}, element("span", { class: "swatch", style: `background:${colour}` }), text);

function ramp(name, low, middle, high) {
  return element(
    "div",
    { class: "ramp" },
    element("div", { class: "ramp-bar", style: `background:${rampCss(name)}` }),
    element(
      "div",
      { class: "ramp-ends" },
      [low, middle, high].map((text) => element("span", {}, text)),
    ),
  );
}

const damageRamp = ({ low, high }) => ramp("damage", timeText(low), timeText((low + high) / 2), timeText(high));

const srgb = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
const cssOf = ([r, g, b]) => `rgb(${srgb(r)} ${srgb(g)} ${srgb(b)})`;

function materialLegend(materials) {
  return element(
    "ul",
    { class: "swatches" },
    materials.map((m) =>
      swatch(cssOf(m.pbrMetallicRoughness?.baseColorFactor ?? [0.6, 0.6, 0.6]), m.name.replaceAll("_", " ")),
    ),
  );
}

function generationLegend(pieces) {
  const last = pieces.reduce((most, piece) => Math.max(most, piece.generation), 0);
  const names = ["bodies of the scene", "their fragments", "fragments of those"];
  const items = Array.from({ length: Math.min(last, lastGeneration) + 1 }, (_, i) => {
    const more = i === lastGeneration && last > lastGeneration ? " and later" : "";
    return swatch(generationCss(i), `${i}${names[i] ? ` · ${names[i]}` : more}`);
  });
  return element("ul", { class: "swatches" }, items);
}

/**
 * `range` { low, high } of damage times [s], null: the file has none; `fastest` [m/s]: where the ramp of speeds ends.
 * A mode: `key` on the keyboard, `name`, `stage` (a mode of Stage), `colours` of the pieces (null: by their speeds at
 * every frame), `legend`, and `missing`: why it cannot be shown, or null.
 */
export function colourModes({ materials, pieces, range, fastest }) {
  const fragments = pieces.filter((piece) => piece.parent >= 0).length;
  return [
    {
      id: "fragment",
      key: "1",
      name: "Fragment",
      stage: "piece",
      colours: () => pieces.map(fragmentColour),
      legend: () => element("p", {}, `${counted(fragments, "fragment")}, crack faces darker`),
    },
    {
      id: "generation",
      key: "2",
      name: "Generation",
      stage: "piece",
      colours: () => pieces.map(generationColour),
      legend: () => generationLegend(pieces),
    },
    {
      id: "damage",
      key: "3",
      name: "Damage time",
      stage: "damage",
      missing: range ? null : "fragments.glb holds no damage times",
      legend: () =>
        range
          ? element("div", {}, "Crack faces, by when they broke", damageRamp(range))
          : element("p", {}, "fragments.glb holds no damage times"),
    },
    {
      id: "speed",
      key: "4",
      name: "Speed",
      stage: "piece",
      legend: () => ramp("speed", "0", speedText(fastest / 4), `≥ ${speedText(fastest)}`),
    },
    { id: "material", key: "0", name: "Material", stage: "material", legend: () => materialLegend(materials) },
  ];
}

/** Turns speeds [m/s] into colours; even steps of the square root, so that slow pieces differ, too. */
export function speedColours(fastest) {
  const colours = rampLinear("speed");
  return (speeds) =>
    Array.from(speeds, (v) => colours[Math.round(255 * Math.sqrt(Math.min(1, v / Math.max(fastest, 1e-12))))]);
}
