import { count, energy, impulse, percent, pressure, speed, time, volume } from "../format.js";
import { SortableTable } from "./sortable.js";

const solveSeconds = ({ seconds }) => seconds.sample + seconds.solve + seconds.extract + seconds.cut;

const columns = [
  { name: "Body", value: (f) => f.body, text: (f) => f.body },
  { name: "Time", value: (f) => f.time, text: (f) => time(f.time), numeric: true },
  {
    name: "Fragments",
    value: (f) => f.fragments,
    text: (f) => (f.fragments > 0 ? count(f.fragments) : "stays whole"),
    numeric: true,
  },
  { name: "Approach", value: (f) => f.approach_speed, text: (f) => speed(f.approach_speed), numeric: true },
  { name: "Impulse", value: (f) => f.delivered_impulse, text: (f) => impulse(f.delivered_impulse), numeric: true },
  { name: "Damaged", value: (f) => f.damaged_share, text: (f) => percent(f.damaged_share), numeric: true },
  { name: "Particles", value: (f) => f.particles, text: (f) => count(f.particles), numeric: true },
  { name: "Steps", value: (f) => f.steps, text: (f) => count(f.steps), numeric: true },
  {
    name: "Front strength",
    value: (f) => f.propagation_strength,
    text: (f) => pressure(f.propagation_strength),
    numeric: true,
  },
  { name: "Ended by", value: (f) => f.stopped_by, text: (f) => f.stopped_by },
  { name: "Took", value: solveSeconds, text: (f) => time(solveSeconds(f)), numeric: true },
];

const energyColumns = [
  { name: "Energy before", value: (f) => f.kinetic_before, text: (f) => energy(f.kinetic_before), numeric: true },
  { name: "Energy after", value: (f) => f.kinetic_after, text: (f) => energy(f.kinetic_after), numeric: true },
];

const sizeColumns = [
  {
    name: "Median volume",
    value: (f) => f.median_volume ?? 0,
    text: (f) => (f.median_volume ? volume(f.median_volume) : "–"),
    numeric: true,
  },
  {
    name: "Largest share",
    value: (f) => f.largest_share ?? 0,
    text: (f) => (f.largest_share ? percent(f.largest_share) : "–"),
    numeric: true,
  },
];

// The report keeps what belongs to one fracture in several lists, which name it by its time and body.
function joined(report) {
  const key = ({ time: at, body }) => `${at} ${body}`;
  const energies = new Map(report.energy.map((entry) => [key(entry), entry]));
  const sizes = new Map((report.statistics?.per_fracture ?? []).map((entry) => [key(entry), entry]));
  return report.fractures.map((f, number) => ({ ...energies.get(key(f)), ...sizes.get(key(f)), ...f, number }));
}

/** Every solve; `show(fracture)` is called when one is chosen. */
export function fractureTable(report, show) {
  return new SortableTable({
    caption: "Fractures",
    columns: [...columns, ...energyColumns, ...(report.statistics?.per_fracture ? sizeColumns : [])],
    rows: joined(report),
    id: (f) => f.number,
    choose: show,
    chooseLabel: (f) => `Show ${f.body} at ${time(f.time)}`,
    sort: { column: 1, down: false },
  }).node;
}
