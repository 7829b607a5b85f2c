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

function showCharts(report, player) {
  const counts = report.fragments.count > 0 ? countChart(report) : null;
  const charts = [counts, volumeChart(report), stageChart(report), effectChart(report), energyChart(report)];
  byId("chart-grid").append(...charts.filter(Boolean));
  if (counts) player.addEventListener("frame", () => counts.setTime(player.time));
}

function showTables(report, player, selection) {
  byId("fragment-table").append(
    report.fragments.count > 0 ? fragmentTable(report, selection) : nothing("Nothing broke."),
  );
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
  showOverview(report);
  showNotices(report);
  showCharts(report, player);
  showTables(report, player, selection);
  byId("run-facts").append(accuracyStatement(report), ...runFacts(report));
  showScene(scene);
  say("Reading the geometry …");
  // The geometry stands behind this script, and what is above is worth showing before it is read.
  document.addEventListener("DOMContentLoaded", () =>
    requestAnimationFrame(() =>
      setTimeout(() => openViewer(readGeometry(), { scene, fractures: report.fractures, player, selection })),
    ),
  );
}

main();
