import { area, count, mass, time, volume } from "../format.js";
import { SortableTable } from "./sortable.js";

const columns = [
  { name: "Name", value: (f) => f.name, text: (f) => f.name },
  { name: "Body", value: (f) => f.body, text: (f) => f.body },
  { name: "Generation", value: (f) => f.generation, text: (f) => count(f.generation), numeric: true },
  { name: "Born", value: (f) => f.birth_time, text: (f) => time(f.birth_time), numeric: true },
  { name: "Volume", value: (f) => f.volume, text: (f) => volume(f.volume), numeric: true },
  { name: "Mass", value: (f) => f.mass, text: (f) => mass(f.mass), numeric: true },
  { name: "Area", value: (f) => f.area, text: (f) => area(f.area), numeric: true },
  { name: "Closed", value: (f) => Number(f.closed), text: (f) => (f.closed ? "yes" : "no") },
];

/** Fragments that exist at the end, the largest first; rows and selection follow each other. */
export function fragmentTable(report, selection) {
  const table = new SortableTable({
    caption: "Fragments",
    columns,
    rows: report.fragments.list,
    id: (f) => f.id,
    choose: (f) => selection.set(f.id),
    chooseLabel: (f) => `Select ${f.name}`,
    sort: { column: 4, down: true },
  });
  selection.addEventListener("change", () => table.select(selection.id));
  return table.node;
}
