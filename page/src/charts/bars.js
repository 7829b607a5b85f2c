// Amounts by name, as horizontal bars.
import { svg } from "../dom.js";
import { canvas } from "./axes.js";

const ROW = 30;

/** `items`: [{ name, value, text, says, kind }]; `kind` picks the colour of the bar. */
export function bars(width, items) {
  const names = Math.min(0.36 * width, 10 + 7.4 * Math.max(...items.map((item) => item.name.length)));
  const texts = 10 + 7.2 * Math.max(...items.map((item) => item.text.length));
  const most = Math.max(...items.map((item) => item.value), 1e-300);
  const room = Math.max(20, width - names - texts);
  const marks = items.map((item, i) => {
    const y = i * ROW + 4;
    const length = (item.value / most) * room;
    const node = svg(
      "g",
      {},
      svg("rect", { class: "hit", x: 0, y: y - 2, width, height: ROW - 2 }),
      svg("text", { class: "bar-name", x: names - 8, y: y + 15, "text-anchor": "end" }, item.name),
      svg("rect", { class: "bar-room", x: names, y: y + 3, width: room, height: ROW - 14, rx: 2 }),
      svg("rect", {
        class: `bar mark-point ${item.kind ?? "series-0"}`,
        x: names,
        y: y + 3,
        width: Math.max(length, item.value > 0 ? 1.5 : 0),
        height: ROW - 14,
        rx: 2,
      }),
      svg("text", { class: "bar-text", x: names + room + 6, y: y + 15 }, item.text),
    );
    return { node, text: item.says ?? `${item.name}: ${item.text}` };
  });
  return {
    node: canvas(
      width,
      items.length * ROW + 4,
      marks.map((mark) => mark.node),
    ),
    marks,
  };
}
