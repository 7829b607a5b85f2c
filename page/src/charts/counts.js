// Fragments over time, with the viewer's moment as a line.
import { svg } from "../dom.js";
import { count, counted, time } from "../format.js";
import { countEvents, totalCounts } from "../data/statistics.js";
import { axes, canvas, inner, path } from "./axes.js";
import { figure } from "./figure.js";
import { evenTicks, linear } from "./scales.js";

const HEIGHT = 260;

const told = (step) =>
  `${time(step.time)}: ${step.changes.map((c) => `${c.fresh} new of ${c.body}`).join(", ")}; ${counted(step.alive, "fragment")}`;

// From nothing, in steps, to the end of the run.
function outline(steps, end, x, y) {
  const points = [[x(0), y(0)]];
  let alive = 0;
  for (const step of steps) {
    points.push([x(step.time), y(alive)], [x(step.time), y(step.alive)]);
    alive = step.alive;
  }
  points.push([x(end), y(alive)]);
  return points;
}

function drawCounts(width, steps, end) {
  const most = Math.max(1, ...steps.map((step) => step.alive));
  const box = inner(width, HEIGHT);
  const x = linear([0, end], [box.left, box.right]);
  const y = linear([0, most * 1.05], [box.bottom, box.top]);
  const line = outline(steps, end, x, y);
  const marks = steps.map((step) => ({
    text: told(step),
    node: svg(
      "g",
      {},
      svg("circle", { class: "hit", cx: x(step.time), cy: y(step.alive), r: 12 }),
      svg("circle", { class: "dot mark-point", cx: x(step.time), cy: y(step.alive), r: 4 }),
    ),
  }));
  const area = `${path([[x(0), y(0)], ...line, [x(end), y(0)]])}Z`;
  const playhead = svg("line", { class: "playhead", y1: box.top, y2: box.bottom, x1: x(0), x2: x(0) });
  const node = canvas(
    width,
    HEIGHT,
    axes(
      width,
      HEIGHT,
      { scale: x, ticks: evenTicks(x.domain, width / 90), text: time, title: "Time" },
      { scale: y, ticks: evenTicks(y.domain, 5).filter(Number.isInteger), text: count, title: "Fragments" },
    ),
    svg("path", { class: "area", d: area }),
    svg("path", { class: "line series-0", d: path(line) }),
    playhead,
    marks.map((mark) => mark.node),
  );
  return { node, marks, playhead, x };
}

/** The figure; its `setTime(seconds)` moves the line. */
export function countChart(report) {
  const steps = totalCounts(countEvents(report));
  const end = Math.max((report.frames.count - 1) / report.frames.rate, steps.at(-1)?.time ?? 0, 1e-9);
  let drawing = null;
  let now = 0;
  const place = () => {
    if (!drawing) return;
    const at = drawing.x(Math.min(now, end));
    drawing.playhead.setAttribute("x1", at);
    drawing.playhead.setAttribute("x2", at);
  };
  const chart = figure({
    title: "Fragments over time",
    summary: report.statistics
      ? `${counted(report.fragments.count, "fragment")} at the end.`
      : "Of the fragments that exist at the end; report.json holds no statistics, which would count those that broke again.",
    draw: (width) => {
      drawing = drawCounts(width, steps, end);
      place();
      return drawing;
    },
    table: () => ({
      head: ["Time", "Body", "New", "Alive of the body"],
      rows: steps.flatMap((s) => s.changes.map((c) => [time(s.time), c.body, count(c.fresh), count(c.alive)])),
    }),
  });
  const setTime = (seconds) => {
    now = seconds;
    place();
  };
  return Object.assign(chart, { setTime });
}
