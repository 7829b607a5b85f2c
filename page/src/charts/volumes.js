// How large the fragments are: the share of them that is larger than a volume, and the laws fitted to it.
import { element, svg } from "../dom.js";
import { count, counted, number, percent, volume } from "../format.js";
import { bestFit, lawName, survivalOf } from "../data/laws.js";
import { median, sortedVolumes } from "../data/statistics.js";
import { axes, canvas, inner, path } from "./axes.js";
import { figure, foldedTable } from "./figure.js";
import { logTicks, logarithmic } from "./scales.js";

const HEIGHT = 340;
const CURVE_POINTS = 160;
/** Fragments that get a mark of their own, at most. */
const MARKS = 48;
const MOST_DOTS = 400;

// The share of fragments at least as large as the i-th smallest.
const share = (i, n) => (n - i) / n;

// Evenly along the axis of volumes, always with the smallest and the largest.
function markedIndices(volumes) {
  const n = volumes.length;
  if (n <= MARKS) return volumes.map((_, i) => i);
  const spread = volumes[n - 1] / volumes[0];
  const chosen = new Set();
  for (let k = 0; k < MARKS; ++k) {
    const target = volumes[0] * spread ** (k / (MARKS - 1));
    chosen.add(
      Math.max(
        0,
        volumes.findIndex((v) => v >= target * (1 - 1e-9)),
      ),
    );
  }
  return [...chosen.add(n - 1)].sort((a, b) => a - b);
}

function curve(fit, volumes, x, y) {
  const survival = survivalOf(fit);
  if (!survival) return null;
  const low = Math.max(volumes[0], fit.above || 0);
  const high = volumes.at(-1) * 1.3;
  // A law fitted to what lies above a volume speaks of that part of the fragments only.
  const part = volumes.filter((v) => v >= low).length / volumes.length;
  const points = [];
  for (let i = 0; i < CURVE_POINTS; ++i) {
    const v = low * (high / low) ** (i / (CURVE_POINTS - 1));
    const value = part * survival(v);
    if (value >= y.domain[0] && v <= x.domain[1]) points.push([x(v), y(value)]);
  }
  return points.length > 1 ? path(points) : null;
}

function scales(width, volumes) {
  const box = inner(width, HEIGHT);
  const spread = volumes.at(-1) / volumes[0];
  const margin = spread > 1 ? spread ** 0.04 : 2;
  return {
    x: logarithmic([volumes[0] / margin, volumes.at(-1) * margin], [box.left, box.right]),
    y: logarithmic([0.7 / volumes.length, 1.15], [box.bottom, box.top]),
  };
}

function drawVolumes(width, volumes, fits, shown) {
  const n = volumes.length;
  const { x, y } = scales(width, volumes);
  const marks = markedIndices(volumes).map((i) => ({
    text: `${counted(n - i, "fragment")} of ${count(n)} (${percent(share(i, n))}) with at least ${volume(volumes[i])}`,
    node: svg(
      "g",
      {},
      svg("circle", { class: "hit", cx: x(volumes[i]), cy: y(share(i, n)), r: 9 }),
      svg("circle", { class: "dot mark-point", cx: x(volumes[i]), cy: y(share(i, n)), r: 3.2 }),
    ),
  }));
  const steps = volumes.flatMap((v, i) => [
    [x(v), y(share(i, n))],
    [x(v), y(share(i + 1, n) || y.domain[0])],
  ]);
  const curves = fits.map((fit, k) => {
    const d = shown.has(fit.law) && curve(fit, volumes, x, y);
    return d ? svg("path", { class: `line law series-${k + 1}`, d }) : null;
  });
  const node = canvas(
    width,
    HEIGHT,
    axes(
      width,
      HEIGHT,
      { scale: x, ticks: logTicks(x.domain, width / 100), text: volume, title: "Volume of a fragment" },
      { scale: y, ticks: logTicks(y.domain), text: percent, title: "Share at least as large" },
    ),
    n <= MOST_DOTS ? null : svg("path", { class: "line series-0", d: path(steps) }),
    curves,
    n <= MOST_DOTS
      ? volumes.map((v, i) => svg("circle", { class: "dot small", cx: x(v), cy: y(share(i, n)), r: 2.2 }))
      : null,
    marks.map((mark) => mark.node),
  );
  return { node, marks };
}

function legend(fits, best, shown, redraw) {
  const items = fits.map((fit, k) => {
    const box = element("input", { type: "checkbox", checked: shown.has(fit.law) });
    box.addEventListener("change", () => {
      if (box.checked) shown.add(fit.law);
      else shown.delete(fit.law);
      redraw();
    });
    return element(
      "li",
      {},
      element(
        "label",
        {},
        box,
        element("span", { class: `stroke series-${k + 1}` }),
        lawName(fit.law),
        fit === best ? " (best)" : "",
      ),
    );
  });
  return element("ul", { class: "chart-legend", "aria-label": "Fitted laws to show" }, items);
}

const interval = ({ name, value, low, high }) =>
  `${name} ${number(value)}${Number.isFinite(low) && low !== null ? ` (${number(low)} … ${number(high)})` : ""}`;

const fitRows = (fits) => ({
  head: ["Law", "Parameters (with their intervals)", "Fitted to", "KS distance", "p-value", "log-likelihood", "AIC"],
  rows: fits.map((fit) => [
    lawName(fit.law),
    fit.parameters.map(interval).join("; "),
    `${count(fit.count)}${fit.above ? ` above ${volume(fit.above)}` : ""}`,
    number(fit.ks),
    number(fit.p_value),
    number(fit.log_likelihood, 5),
    number(fit.aic, 5),
  ]),
});

function sentence(volumes, statistics, fits) {
  const sizes = `From ${volume(volumes[0])} to ${volume(volumes.at(-1))}, half of them above ${volume(median(volumes))}.`;
  if (!statistics) return `${sizes} report.json holds no statistics: no laws are fitted.`;
  if (fits.length === 0) return `${sizes} ${statistics.fits_note || "No laws are fitted."}`;
  const best = bestFit(fits);
  return [sizes, best && `Of the laws, ${lawName(best.law)} has the lowest AIC.`, statistics.fits_note]
    .filter(Boolean)
    .join(" ");
}

/** Null without fragments. */
export function volumeChart(report) {
  const volumes = sortedVolumes(report).filter((v) => v > 0);
  if (volumes.length === 0) return null;
  const statistics = report.statistics;
  const fits = (statistics?.fits ?? []).filter((fit) => (fit.of ?? "volume") === "volume");
  const best = bestFit(fits);
  const shown = new Set(fits.map((fit) => fit.law));
  let redraw = () => {};
  const below =
    fits.length === 0
      ? []
      : [legend(fits, best, shown, () => redraw()), foldedTable("Fitted laws", () => fitRows(fits), "Fitted laws")];
  const chart = figure({
    title: "Volumes of the fragments",
    summary: sentence(volumes, statistics, fits),
    draw: (width) => drawVolumes(width, volumes, fits, shown),
    table: () => ({
      head: ["Volume", "Fragments at least as large", "Share"],
      rows: volumes.map((v, i) => [volume(v), count(volumes.length - i), percent(share(i, volumes.length))]),
    }),
    after: below,
  });
  redraw = chart.redraw;
  return chart;
}
