// Where the time of the run went: its stages, and its effects.
import { element } from "../dom.js";
import { count, counted, percent, time, words } from "../format.js";
import { bars } from "./bars.js";
import { figure } from "./figure.js";

const STAGES = {
  setup: "Setup",
  rigid: "Rigid motion",
  sample: "Sampling",
  solve: "Damage solves",
  extract: "Crack surfaces",
  cut: "Cutting",
  export: "Writing files",
  checkpoint: "Checkpoints",
};

export function stageChart(report) {
  const { total } = report.seconds;
  const stages = Object.entries(STAGES).map(([key, name]) => ({ name, value: report.seconds[key] ?? 0 }));
  const rest = total - stages.reduce((sum, stage) => sum + stage.value, 0);
  if (rest > 0.01 * total) stages.push({ name: "Other", value: rest, kind: "muted" });
  const items = stages.map((stage) => ({
    ...stage,
    text: time(stage.value),
    says: `${stage.name}: ${time(stage.value)}, ${percent(stage.value / total)} of the run`,
  }));
  return figure({
    title: "Seconds per stage",
    summary: `${time(total)} in all${report.threads > 0 ? `, ${counted(report.threads, "thread")}` : ""}. Solves of several bodies may run side by side.`,
    draw: (width) => bars(width, items),
    table: () => ({
      head: ["Stage", "Seconds", "Share of the run"],
      rows: items.map((item) => [item.name, item.text, percent(item.value / total)]),
    }),
  });
}

const workOf = (effect) =>
  Object.entries(effect.work)
    .map(([what, n]) => `${count(n)} ${words(what)}`)
    .join(", ");

/** Effects that ran with what they took, then those that did not with the reason. */
export function effectChart(report) {
  const ran = report.effects.filter((effect) => effect.ran);
  const skipped = report.effects.filter((effect) => !effect.ran);
  const items = ran.map((effect) => ({
    name: words(effect.name),
    value: effect.seconds,
    text: time(effect.seconds),
    says: `${words(effect.name)}: ${time(effect.seconds)}, ${workOf(effect)}`,
    kind: "series-2",
  }));
  const list = element(
    "ul",
    { class: "skipped" },
    skipped.map((effect) =>
      element(
        "li",
        {},
        element("span", { class: "tag" }, "skipped"),
        ` ${words(effect.name)} `,
        element("span", { class: "quiet" }, `– ${effect.why}`),
      ),
    ),
  );
  return figure({
    title: "Effects",
    summary: `${ran.length} ran, ${skipped.length} were skipped. Those that ran may share their time.`,
    draw: (width) =>
      items.length > 0 ? bars(width, items) : bars(width, [{ name: "none ran", value: 0, text: "0 s" }]),
    table: () => ({
      head: ["Effect", "Asked", "Ran", "Why", "Work", "Seconds"],
      rows: report.effects.map((e) => [
        words(e.name),
        e.asked,
        e.ran ? "yes" : "no",
        e.why,
        workOf(e),
        time(e.seconds),
      ]),
    }),
    after: skipped.length > 0 ? [list] : [],
  });
}
