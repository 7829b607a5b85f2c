// The report page: data of one run in, everything about it on one page.
import { byId, element } from "./dom.js";
import { readGeometry, readReport, readScene } from "./data/run.js";
import { countChart } from "./charts/counts.js";
import { energyChart } from "./charts/energies.js";
import { effectChart, stageChart } from "./charts/seconds.js";
import { volumeChart } from "./charts/volumes.js";
import { accuracyStatement } from "./sections/accuracy.js";
import { showNotices } from "./sections/notices.js";
import { showOverview } from "./sections/overview.js";
import { runFacts } from "./sections/run_facts.js";
import { showScene } from "./sections/scene.js";
import { fractureTable } from "./tables/fractures.js";
import { fragmentTable } from "./tables/fragments.js";
import { frameAfter } from "./viewer/controls.js";
import { openViewer, say } from "./viewer/open.js";
import { Player } from "./viewer/player.js";
import { Selection } from "./viewer/selection.js";

const nothing = (text) => element("p", { class: "quiet" }, text);

// One part that cannot be shown, of a report of another version perhaps, leaves the others.
function attempt(place, show) {
  try {
    show();
  } catch (error) {
    byId(place).append(nothing(`This part cannot be shown: ${error.message}.`));
    console.error(error);
  }
}

function showCharts(report, player) {
  const append = (make) => attempt("chart-grid", () => byId("chart-grid").append(make(report) ?? ""));
  append(() => {
    if (report.fragments.count === 0 || report.frames.count < 2) return null;
    const counts = countChart(report);
    player.addEventListener("frame", () => counts.setTime(player.time));
    return counts;
  });
  for (const make of [volumeChart, stageChart, effectChart, energyChart]) append(make);
}

function showFragments(report, selection) {
  byId("fragment-table").append(
    report.fragments.count > 0 ? fragmentTable(report, selection) : nothing("Nothing broke."),
  );
}

function showFractures(report, player, selection) {
  const show = (fracture) => {
    player.pause();
    player.seek(frameAfter(player, fracture.time));
    selection.set(fracture.piece);
    byId("viewer").scrollIntoView();
  };
  byId("fracture-table").append(
    report.fractures.length > 0 ? fractureTable(report, show) : nothing("No contact was hard enough for a solve."),
  );
}

function main() {
  const report = readReport();
  const scene = readScene();
  const player = new Player(report.frames);
  const selection = new Selection();
  attempt("tiles", () => showOverview(report));
  attempt("notice-list", () => showNotices(report));
  showCharts(report, player);
  attempt("fragment-table", () => showFragments(report, selection));
  attempt("fracture-table", () => showFractures(report, player, selection));
  attempt("run-facts", () => byId("run-facts").append(accuracyStatement(report), ...runFacts(report)));
  attempt("scene-echo", () => showScene(scene));
  say("Reading the geometry …");
  // The geometry stands behind this script, and what is above is worth showing before it is read.
  document.addEventListener("DOMContentLoaded", () =>
    requestAnimationFrame(() =>
      setTimeout(() => openViewer(readGeometry(), { scene, fractures: report.fractures, player, selection })),
    ),
  );
}

main();
