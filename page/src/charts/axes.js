// The frame of a chart with two axes.
import { svg } from "../dom.js";

const LEFT = 68;
const RIGHT = 18;
const TOP = 12;
const BOTTOM = 42;

/** The box that is left for the data. */
export const inner = (width, height) => ({ left: LEFT, right: width - RIGHT, top: TOP, bottom: height - BOTTOM });

/** `x`, `y`: { scale, ticks, text(tick), title }. */
export function axes(width, height, x, y) {
  const box = inner(width, height);
  const vertical = x.ticks.map((tick) => {
    const at = x.scale(tick);
    return svg(
      "g",
      {},
      svg("line", { class: "grid", x1: at, x2: at, y1: box.top, y2: box.bottom }),
      svg("text", { class: "tick", x: at, y: box.bottom + 16, "text-anchor": "middle" }, x.text(tick)),
    );
  });
  const horizontal = y.ticks.map((tick) => {
    const at = y.scale(tick);
    return svg(
      "g",
      {},
      svg("line", { class: "grid", x1: box.left, x2: box.right, y1: at, y2: at }),
      svg("text", { class: "tick", x: box.left - 7, y: at + 4, "text-anchor": "end" }, y.text(tick)),
    );
  });
  const middle = (box.top + box.bottom) / 2;
  return svg(
    "g",
    { "aria-hidden": "true" },
    vertical,
    horizontal,
    svg("line", { class: "axis", x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom }),
    svg(
      "text",
      { class: "axis-title", x: (box.left + box.right) / 2, y: height - 6, "text-anchor": "middle" },
      x.title,
    ),
    svg(
      "text",
      { class: "axis-title", x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})` },
      y.title,
    ),
  );
}

export const canvas = (width, height, ...children) => svg("svg", { viewBox: `0 0 ${width} ${height}` }, ...children);

export const path = (points) => points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
