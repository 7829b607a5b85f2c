// Where the work of all contacts went.
import { counted, energy, percent, time } from "../format.js";
import { bars } from "./bars.js";
import { figure } from "./figure.js";

const PARTS = [
  ["kinetic", "Motion", "series-0"],
  ["elastic", "Elastic", "series-4"],
  ["fracture", "Damage", "series-2"],
  ["viscous", "Viscosity", "series-3"],
  ["numerical", "Lost on the grid", "muted"],
];

const parts = (ledger) => ({ ...ledger, elastic: ledger.tension + ledger.compression });

/** Null when no solve kept a ledger. */
export function energyChart(report) {
  const solves = report.fractures.filter((f) => f.energy).map((f) => ({ ...f, parts: parts(f.energy) }));
  if (solves.length === 0) return null;
  const total = (key) => solves.reduce((sum, f) => sum + f.parts[key], 0);
  const work = total("work");
  const items = PARTS.map(([key, name, kind]) => ({
    name,
    kind,
    value: Math.max(0, total(key)),
    text: energy(total(key)),
    says: `${name}: ${energy(total(key))}, ${percent(total(key) / work)} of the work`,
  }));
  return figure({
    title: "Work of the contacts",
    summary: `${energy(work)} in ${counted(solves.length, "solve")}, and where it was at the end of each. What the grid cannot resolve is lost in the transfers between particles and grid.`,
    draw: (width) => bars(width, items),
    table: () => ({
      head: ["Solve", "Work", ...PARTS.map(([, name]) => name)],
      rows: solves.map((f) => [
        `${f.body}, ${time(f.time)}`,
        energy(f.parts.work),
        ...PARTS.map(([key]) => energy(f.parts[key])),
      ]),
    }),
  });
}
