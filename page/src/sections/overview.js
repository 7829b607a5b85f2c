// The head of the page: what was run, and the numbers that one looks for first.
import { byId, element } from "../dom.js";
import { count, counted, memory, number, percent, speed, time } from "../format.js";
import { largestShare } from "../data/statistics.js";

const tile = (name, value, more, kind) =>
  element(
    "div",
    { class: kind ? `tile ${kind}` : "tile" },
    element("dt", {}, name),
    element("dd", {}, element("strong", {}, value), more ? element("span", { class: "quiet" }, more) : null),
  );

const machine = ({ threads, peak_memory_mb: megabytes }) =>
  [threads > 0 && counted(threads, "thread"), megabytes > 0 && memory(1e6 * megabytes)].filter(Boolean).join(", ");

function tiles(report) {
  const { fragments, fractures, frames, motion, seconds } = report;
  const open = fragments.count - fragments.closed;
  const broke = fractures.filter((f) => f.fragments > 0).length;
  const share = largestShare(report);
  return [
    tile(
      "Fragments",
      count(fragments.count),
      fragments.count === 0 ? "nothing broke" : open === 0 ? "all closed" : `${count(open)} not closed`,
      open > 0 ? "warn" : null,
    ),
    fractures.length > 0 ? tile("Fractures", count(broke), `in ${counted(fractures.length, "solve")}`) : null,
    Number.isFinite(share) ? tile("Largest fragment", percent(share), "of all volume") : null,
    tile("Volume error", number(fragments.volume_error, 2), "worst fracture"),
    motion?.fastest_fragment.name
      ? tile("Fastest fragment", speed(motion.fastest_fragment.speed), motion.fastest_fragment.name)
      : null,
    frames.count > 1 ? tile("Frames", count(frames.count), `${number(frames.rate)} a second`) : null,
    tile("Took", time(seconds.total), machine(report)),
  ];
}

export function showOverview(report) {
  document.title = `${report.scene} · Sunder report`;
  byId("title").textContent = report.scene;
  const run = [
    report.quality && `${report.quality} quality`,
    `seed ${report.seed}`,
    `Sunder ${report.version} (${report.git})`,
  ];
  byId("subtitle").replaceChildren(
    run.filter(Boolean).join(" · "),
    report.interrupted ? element("span", { class: "tag warn" }, "interrupted") : "",
  );
  byId("tiles").append(...tiles(report).filter(Boolean));
  byId("colophon").textContent = `Sunder ${report.version} (${report.git})`;
}
