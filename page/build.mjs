// node build.mjs DOCS OUTPUT.cpp: bundles the page into one HTML template and writes it as the source of
// sunder::pipeline::detail::page_template (pipeline/detail/page_template.h). DOCS is docs/report.md: the page says what a
// fallback means in its words.
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const MARKERS = ["{{report}}", "{{scene}}", "{{geometry_size}}", "{{geometry}}"];
// Nothing in HTML, CSS or minified JavaScript ends a raw string with this name by chance; that none does is checked.
const DELIMITER = "sunder_page";

async function bundle(entry, options) {
  const result = await build({ entryPoints: [entry], bundle: true, minify: true, write: false, ...options });
  return result.outputFiles[0].text;
}

// { name: meaning } from the table of the section "Fallbacks"; a row may name several.
function fallbacks(markdown) {
  const section = markdown.split("\n## ").find((part) => part.startsWith("Fallbacks"));
  const meanings = {};
  for (const [, names, meaning] of section.matchAll(/^\| (`.*) \| (.*) \|$/gm))
    for (const [, name] of names.matchAll(/`(\w+)`/g)) meanings[name] = meaning.replaceAll("`", "");
  if (Object.keys(meanings).length === 0) throw new Error("no fallbacks found in docs/report.md");
  return meanings;
}

async function html(docs) {
  const define = { FALLBACKS: JSON.stringify(fallbacks(await readFile(docs, "utf8"))) };
  const script = await bundle("src/main.js", { format: "iife", target: "es2022", legalComments: "inline", define });
  const style = await bundle("src/style/page.css", { target: "chrome100" });
  const template = await readFile("src/index.html", "utf8");
  // A function: in a string `$&` and its like would be replaced.
  return template
    .replace("{{style}}", () => style.trim())
    .replace("{{script}}", () => script.trim().replaceAll("</script", "<\\/script"));
}

function split(text) {
  const parts = [];
  let rest = text;
  for (const marker of MARKERS) {
    const pieces = rest.split(marker);
    if (pieces.length !== 2) throw new Error(`the page needs ${marker} exactly once, in the order of MARKERS`);
    parts.push(pieces[0]);
    rest = pieces[1];
  }
  return [...parts, rest];
}

function source(parts) {
  const literals = parts.map((part) => {
    if (part.includes(`)${DELIMITER}"`)) throw new Error("the page holds the end of its own literal");
    return `    R"${DELIMITER}(${part})${DELIMITER}"`;
  });
  return `#include "pipeline/detail/page_template.h"

namespace sunder::pipeline::detail {

const std::array<std::string_view, ${parts.length}> page_template = {
${literals.join(",\n")}};

}  // namespace sunder::pipeline::detail
`;
}

const [docs, output] = process.argv.slice(2);
await writeFile(output, source(split(await html(docs))));
