// How far the results can be trusted: what was measured of its quality level, and what this run measured of itself.
import { element } from "../dom.js";
import { count, length, number, percent, pressure } from "../format.js";

const worst = (list, key) => Math.max(...list.map(key));

function bandSentence(fractures) {
  const coarse = fractures.filter((f) => f.damage_band > f.admissible_band);
  if (coarse.length === 0)
    return "Cracks are resolved within the process zone of their materials: strength and fracture energy both hold.";
  const f = coarse.reduce((a, b) => (a.damage_band / a.admissible_band > b.damage_band / b.admissible_band ? a : b));
  return (
    `Cracks are bands of ${length(f.damage_band)}, where ${length(f.admissible_band)} would keep strength and fracture energy at once. ` +
    `So crack fronts run at ${pressure(f.propagation_strength)} instead of ${pressure(f.tensile_strength)}; new cracks need the full strength.`
  );
}

function energySentence(fractures) {
  const ledgers = fractures.filter((f) => f.energy && f.energy.work > 0).map((f) => f.energy);
  if (ledgers.length === 0) return null;
  const sum = (key) => ledgers.reduce((total, ledger) => total + ledger[key], 0);
  return `Of the work of the contacts ${percent(sum("numerical") / sum("work"))} was lost in transfers between particles and grid.`;
}

export function accuracyStatement(report) {
  const { fractures, fragments } = report;
  const lines = [
    `${count(fragments.closed)} of ${count(fragments.count)} fragments are closed; cuts keep the volume to ${number(fragments.volume_error, 2)}.`,
  ];
  if (fractures.length > 0) {
    lines.push(
      `A solve has up to ${count(worst(fractures, (f) => f.particles))} particles.`,
      bandSentence(fractures),
      energySentence(fractures),
      `Fragments take over momentum to ${number(
        worst(fractures, (f) => f.momentum_error),
        2,
      )} of what there was.`,
    );
  }
  return element(
    "div",
    { class: "card" },
    element("h3", {}, "Accuracy"),
    report.accuracy ? element("p", {}, `${report.accuracy[0].toUpperCase()}${report.accuracy.slice(1)}.`) : null,
    element(
      "ul",
      {},
      lines.filter(Boolean).map((line) => element("li", {}, line)),
    ),
  );
}
