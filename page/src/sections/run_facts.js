// The rest of the report in tables: how bodies moved, volumes before and after, what identifies the run.
import { element } from "../dom.js";
import { count, energy, number, percent, speed, time, volume, words } from "../format.js";
import { plainTable } from "../charts/figure.js";

const facts = (title, pairs) =>
  element(
    "div",
    { class: "card" },
    element("h3", {}, title),
    element(
      "dl",
      { class: "facts" },
      pairs
        .filter(([, value]) => value)
        .map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value))),
    ),
  );

function motion({ motion: m }) {
  if (!m?.steps) return null;
  const { name, speed: fastest, time: when } = m.fastest_fragment;
  return facts("Motion", [
    ["Rigid steps", count(m.steps)],
    ["Sub-steps of groups", count(m.sub_steps)],
    ["Bodies times sub-steps", count(m.body_sub_steps)],
    ["Contacts solved", count(m.contacts)],
    ["Fastest start", speed(m.fastest_start)],
    ["Fastest fragment", name ? `${name}, ${speed(fastest)} at ${time(when)}` : "–"],
  ]);
}

function volumes({ statistics }) {
  const closure = statistics?.closure ?? [];
  const sizes = statistics?.volume;
  if (closure.length === 0) return null;
  return element(
    "div",
    { class: "card" },
    element("h3", {}, "Volume"),
    plainTable("Volume of bodies and of their fragments", {
      head: ["Body", "Before", "Fragments", "Error"],
      rows: closure.map((c) => [c.body, volume(c.original), volume(c.fragments), number(c.relative_error, 2)]),
    }),
    sizes
      ? element(
          "p",
          { class: "quiet" },
          `A fragment has between ${volume(sizes.minimum)} and ${volume(sizes.maximum)}: median ${volume(sizes.median)}, mean ${volume(sizes.mean)}.`,
        )
      : null,
  );
}

function energies({ statistics }) {
  const e = statistics?.energy;
  if (!e) return null;
  return facts("Energy", [
    ["Motion at the start", energy(e.kinetic_start)],
    ["Motion at the end", energy(e.kinetic_end)],
    ["Taken by new faces", energy(e.fracture)],
    ["Motion lost in fractures", energy(e.lost_in_fractures)],
  ]);
}

function extraction({ extract: e }) {
  if (!e) return null;
  return facts("Crack surfaces", [
    ["Points", count(e.points)],
    ["Voronoi sites", count(e.sites)],
    ["Faces in the body", count(e.faces)],
    ...Object.entries(e.faces_by_kind).map(([kind, n]) => [`of them ${words(kind)}`, count(n)]),
    ["Pieces", `${count(e.pieces)} (${number(e.effective_pieces)} of equal size)`],
    ["Damaged", percent(e.damaged_share)],
  ]);
}

const identity = (report) =>
  facts("Identity", [
    ["Scene", report.scene],
    ["Quality", report.quality],
    ["Seed", String(report.seed)],
    ["Program", `Sunder ${report.version} (${report.git})`],
    ["Fingerprint", report.fingerprint],
    ["Particle-steps a second", report.mpm.particle_steps > 0 && number(report.mpm.particle_steps_per_second)],
  ]);

export const runFacts = (report) =>
  [volumes(report), energies(report), motion(report), extraction(report), identity(report)].filter(Boolean);
