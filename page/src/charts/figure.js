// A chart on the page: title, drawing that fits its width, what a mark says, and the numbers as a table.
import { element } from "../dom.js";

/** Sets the marks of a drawing up so that one tab stop reaches them all: arrows go from one to the next. */
function makeReachable(marks, say, hush) {
  const focus = (i) => {
    const mark = marks[(i + marks.length) % marks.length];
    for (const { node } of marks) node.setAttribute("tabindex", "-1");
    mark.node.setAttribute("tabindex", "0");
    mark.node.focus();
  };
  const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
  marks.forEach((mark, i) => {
    const { node, text } = mark;
    node.setAttribute("tabindex", i === 0 ? "0" : "-1");
    node.setAttribute("role", "img");
    node.setAttribute("aria-label", text);
    node.setAttribute("data-keys", "");
    node.classList.add("mark");
    node.addEventListener("focus", () => say(mark));
    node.addEventListener("blur", hush);
    node.addEventListener("pointerenter", () => say(mark));
    node.addEventListener("pointerleave", hush);
    node.addEventListener("keydown", (event) => {
      if (event.key === "Escape") return hush();
      const to = event.key in steps ? i + steps[event.key] : { Home: 0, End: marks.length - 1 }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      focus(to);
    });
  });
}

function tooltipIn(plot) {
  const tooltip = element("div", { class: "tooltip", role: "tooltip", hidden: true });
  plot.append(tooltip);
  const say = ({ node, text }) => {
    tooltip.textContent = text;
    tooltip.hidden = false;
    const outer = plot.getBoundingClientRect();
    const inner = (node.querySelector(".mark-point") ?? node).getBoundingClientRect();
    const half = tooltip.offsetWidth / 2;
    const middle = inner.left + inner.width / 2 - outer.left;
    tooltip.style.left = `${Math.min(outer.width - half, Math.max(half, middle))}px`;
    tooltip.style.top = `${Math.max(tooltip.offsetHeight, inner.top - outer.top - 6)}px`;
  };
  return { tooltip, say, hush: () => (tooltip.hidden = true) };
}

/** `head`: texts; `rows`: of texts. */
export function plainTable(caption, { head, rows }) {
  return element(
    "div",
    { class: "table-scroll", tabindex: "0", role: "region", "aria-label": caption },
    element(
      "table",
      {},
      element("caption", { class: "hidden-title" }, caption),
      element(
        "thead",
        {},
        element(
          "tr",
          {},
          head.map((text) => element("th", { scope: "col" }, text)),
        ),
      ),
      element(
        "tbody",
        {},
        rows.map(([first, ...rest]) =>
          element(
            "tr",
            {},
            element("th", { scope: "row" }, first),
            rest.map((text) => element("td", {}, text)),
          ),
        ),
      ),
    ),
  );
}

// Rows are made when they are asked for: there may be thousands.
export function foldedTable(title, table, label = "Numbers as a table") {
  const details = element("details", { class: "numbers" }, element("summary", {}, label));
  details.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(plainTable(title, table()));
  });
  return details;
}

/**
 * `draw(width)` gives { node, marks: [{ node, text }] }; `table()` { head, rows }; `summary`: the chart in a sentence;
 * `after`: nodes below the drawing. The figure's `redraw` draws it anew.
 */
export function figure({ title, summary, draw, table, after = [] }) {
  const plot = element("div", { class: "plot" });
  const figureNode = element(
    "figure",
    { class: "card chart" },
    element("figcaption", {}, element("h3", {}, title), element("p", { class: "quiet" }, summary)),
    plot,
    after,
    table ? foldedTable(title, table) : null,
  );
  let width = 0;
  const redraw = () => {
    if (width === 0) return;
    plot.replaceChildren();
    const { tooltip, say, hush } = tooltipIn(plot);
    // Drawings count in pixels of a page with letters of 15 pixels, and grow with the letters.
    const scale = parseFloat(getComputedStyle(document.documentElement).fontSize) / 15;
    const { node, marks } = draw(Math.round(width / scale));
    node.setAttribute("role", "group");
    node.setAttribute("aria-label", title);
    plot.insertBefore(node, tooltip);
    makeReachable(marks, say, hush);
  };
  new ResizeObserver(([entry]) => {
    const now = Math.round(entry.contentRect.width);
    if (now === width || now === 0) return;
    width = now;
    redraw();
  }).observe(plot);
  return Object.assign(figureNode, { redraw });
}
