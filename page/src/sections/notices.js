// What one should know before believing the rest: notes, fallbacks, repairs, and whether the run was cut short.
import { byId, element } from "../dom.js";
import { words } from "../format.js";

// From docs/report.md, by page/build.mjs.
/* global FALLBACKS */
const meanings = FALLBACKS;

const notice = (kind, tag, ...text) =>
  element(
    "li",
    { class: `notice ${kind}` },
    element("span", { class: `tag ${kind}` }, tag),
    element("div", {}, ...text),
  );

function notices(report) {
  const list = [];
  if (report.interrupted) list.push(notice("warn", "interrupted", "The run was stopped; this is what was finished."));
  const open = report.fragments.count - report.fragments.closed;
  if (open > 0) list.push(notice("warn", "open", `${open} of ${report.fragments.count} fragments are not closed.`));
  for (const [name, times] of Object.entries(report.fallbacks))
    list.push(
      notice("warn", `${times} ×`, element("strong", {}, words(name)), meanings[name] ? `: ${meanings[name]}` : ""),
    );
  for (const note of report.notes) list.push(notice("note", "note", note));
  for (const { body, steps } of report.repairs)
    list.push(notice("note", "repair", element("strong", {}, body), `: ${steps.join("; ")}`));
  return list;
}

export function showNotices(report) {
  const list = notices(report);
  byId("notice-list").replaceChildren(
    list.length > 0
      ? element("ul", { class: "notices" }, list)
      : element("p", { class: "all-well" }, "Nothing to warn of: no fallback was taken, no mesh was repaired."),
  );
}
