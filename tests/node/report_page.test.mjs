// The report page in a browser. SUNDER_PAGE names the folder of an index.html with 27 shards in 24 frames
// (tests/pipeline/burst.h); screenshots go there, too.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { after, afterEach, before, test } from "node:test";
import { launch, openPage } from "./browser.mjs";

const folder = process.env.SUNDER_PAGE;
const file = `file://${folder}/index.html`;
const WIDTHS = [390, 1280, 3840];
let browser;

before(async () => (browser = await launch()));
afterEach(async () => Promise.all((await browser.pages()).slice(1).map((page) => page.close())));
after(() => browser.close());

const state = (page, key) => page.$eval("#viewer", (viewer, name) => viewer.dataset[name], key);

// Names what the viewer shows once it is drawn as well as it can be, without what lies over it.
async function picture(page) {
  await page.waitForSelector("#canvas[data-still]");
  return createHash("sha256")
    .update(await page.evaluate(() => window.picture))
    .digest("hex");
}

async function scrub(page, frame) {
  await page.$eval(
    "#frame",
    (slider, value) => {
      slider.value = value;
      slider.dispatchEvent(new Event("input"));
    },
    frame,
  );
}

test("opens without a complaint and asks for nothing else", async () => {
  const { page, complaints, requests } = await openPage(browser, file);
  assert.equal(await page.$eval("#title", (title) => title.textContent), "burst");
  assert.deepEqual(requests, [file]);
  assert.deepEqual(complaints, []);
});

test("shows another picture at another frame, by slider and by keys", async () => {
  const { page, complaints } = await openPage(browser, file);
  await scrub(page, 0);
  const whole = await picture(page);
  assert.equal(await state(page, "frame"), "1");
  await scrub(page, 12);
  const broken = await picture(page);
  assert.equal(await state(page, "frame"), "13");
  assert.notEqual(broken, whole);
  await page.focus("#canvas");
  await page.keyboard.press("ArrowRight");
  assert.equal(await state(page, "frame"), "14");
  await page.keyboard.press("End");
  assert.equal(await state(page, "frame"), "24");
  await page.keyboard.press("Home");
  assert.equal(await state(page, "frame"), "1");
  assert.equal(await picture(page), whole);
  await page.keyboard.press("]");
  assert.equal(await state(page, "frame"), "3");
  assert.deepEqual(complaints, []);
});

test("colours, the exploded view and hidden outsides change the picture and are reversible", async () => {
  const { page, complaints } = await openPage(browser, file);
  await scrub(page, 8);
  await page.focus("#canvas");
  const seen = new Map();
  for (const [key, mode] of [
    ["0", "material"],
    ["1", "fragment"],
    ["2", "generation"],
    ["3", "damage"],
    ["4", "speed"],
  ]) {
    await page.keyboard.press(key);
    assert.equal(await state(page, "mode"), mode);
    seen.set(mode, await picture(page));
  }
  assert.equal(new Set(seen.values()).size, seen.size, "two modes look alike");
  await page.keyboard.press("1");
  for (const key of ["e", "h"]) {
    await page.keyboard.press(key);
    assert.notEqual(await picture(page), seen.get("fragment"), key);
    await page.keyboard.press(key);
    assert.equal(await picture(page), seen.get("fragment"), key);
  }
  assert.deepEqual(complaints, []);
});

test("selection goes from the table to the view and from the view to the table", async () => {
  const { page, complaints } = await openPage(browser, file);
  await scrub(page, 8);
  const before = await picture(page);
  await page.click("#fragment-table tbody tr:nth-child(3) button");
  const name = await page.$eval("#fragment-table .chosen button", (button) => button.textContent);
  assert.equal(await state(page, "selected"), name);
  assert.notEqual(await picture(page), before);
  // Framed, the piece is where the middle of the canvas is.
  await page.focus("#canvas");
  await page.keyboard.press("f");
  await page.click("#selection button");
  assert.equal(await state(page, "selected"), "");
  await page.click("#canvas");
  assert.equal(await state(page, "selected"), name);
  assert.equal(await page.$eval("#fragment-table .chosen button", (button) => button.textContent), name);
  assert.deepEqual(complaints, []);
});

test("plays by itself unless motion is unwanted", async () => {
  const moving = await openPage(browser, file, { motion: "no-preference" });
  const first = Number(await state(moving.page, "frame"));
  await moving.page.waitForFunction(
    (frame) => Number(document.getElementById("viewer").dataset.frame) > frame,
    {},
    first,
  );
  const still = await openPage(browser, file);
  const label = await still.page.$eval("#play", (button) => button.getAttribute("aria-label"));
  assert.equal(label, "Play");
  await still.page.focus("#canvas");
  await still.page.keyboard.press(" ");
  assert.equal(await still.page.$eval("#play", (button) => button.getAttribute("aria-label")), "Pause");
});

test("fits phones, desks and walls, light and dark", async () => {
  for (const width of WIDTHS) {
    for (const scheme of ["light", "dark"]) {
      const { page, complaints } = await openPage(browser, file, { width, scheme });
      await scrub(page, 8);
      await picture(page);
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(overflow <= 0, `${width} px: ${overflow} px too wide`);
      await page.screenshot({ path: `${folder}/page_${width}_${scheme}.png` });
      assert.deepEqual(complaints, []);
    }
  }
});

test("everybody can use it, by the rules of axe, light and dark", async () => {
  const axe = await readFile(new URL("node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
  for (const scheme of ["light", "dark"]) {
    const { page } = await openPage(browser, file, { scheme });
    await page.$$eval("details", (all) => all.forEach((details) => (details.open = true)));
    await page.click("#fragment-table tbody tr:nth-child(2) button");
    await page.evaluate(axe);
    const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    assert.deepEqual(
      violations.map(({ id, nodes }) => [id, nodes.map((node) => node.html)]),
      [],
    );
  }
});

test("one tab stop leads through each chart, and marks say what they are", async () => {
  const { page } = await openPage(browser, file);
  const stops = await page.$$eval("#chart-grid .plot", (plots) =>
    plots.map((p) => p.querySelectorAll("[tabindex='0']").length),
  );
  assert.ok(stops.length >= 4);
  assert.deepEqual(new Set(stops), new Set([1]));
  await page.$eval("#chart-grid .plot [tabindex='0']", (mark) => mark.focus());
  const tip = () =>
    page.$eval("#chart-grid .plot:has(:focus) .tooltip", (tooltip) => (tooltip.hidden ? "" : tooltip.textContent));
  assert.match(await tip(), /27 new of ball/);
  await page.$eval("#chart-grid figure:nth-child(2) .plot [tabindex='0']", (mark) => mark.focus());
  const first = await tip();
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await tip(), first);
});

test("without WebGL the rest of the page stays", async () => {
  const blind = await launch(["--disable-3d-apis"]);
  const { page } = await openPage(blind, file);
  assert.match(await page.$eval("#stage-message", (message) => message.textContent), /no WebGL 2.*fragments\.glb/s);
  assert.equal(await page.$eval("#play", (button) => button.disabled), true);
  assert.ok((await page.$$("#chart-grid figure")).length >= 4);
  assert.equal((await page.$$("#fragment-table tbody tr")).length, 15);
  await blind.close();
});

// The page with another report or geometry; its address.
async function variant(name, { report = (r) => r, geometry }) {
  let html = await readFile(`${folder}/index.html`, "utf8");
  html = html.replace(/(id="report">)(.*?)(<\/script>)/s, (_, head, json, tail) =>
    [head, JSON.stringify(report(JSON.parse(json))), tail].join(""),
  );
  if (geometry !== undefined)
    html = html.replace(/(id="geometry") data-bytes="\d+">[^<]*/, `$1 data-bytes="${geometry}">`);
  await writeFile(`${folder}/${name}.html`, html);
  return `file://${folder}/${name}.html`;
}

test("geometry that is too large or missing is named, and the rest stays", async () => {
  for (const [size, words] of [
    [312e6, /312 MB.*Blender/s],
    [0, /no fragments\.glb/],
  ]) {
    const { page, complaints } = await openPage(browser, await variant(`bytes_${size}`, { geometry: size }));
    assert.match(await page.$eval("#stage-message", (message) => message.textContent), words);
    assert.equal((await page.$$("#fragment-table tbody tr")).length, 15);
    assert.deepEqual(complaints, []);
  }
});

const parameter = (name, value) => ({ name, value, low: 0.9 * value, high: 1.1 * value });

const STATISTICS = {
  fragments: 27,
  largest_share: 0.2,
  volume: { minimum: 1e-6, median: 2e-6, mean: 3e-6, maximum: 1e-5 },
  closure: [{ body: "ball", original: 1e-4, fragments: 1e-4, relative_error: 1e-15 }],
  counts: [
    { time: 0.1, body: "ball", new: 20, alive: 20 },
    { time: 0.5, body: "ball", new: 8, alive: 27 },
  ],
  fits: [
    {
      law: "mott_2d",
      of: "volume",
      count: 27,
      parameters: [parameter("mu", 2e-5)],
      ks: 0.1,
      p_value: 0.4,
      log_likelihood: 300,
      aic: -598,
      above: null,
    },
    {
      law: "weibull",
      of: "volume",
      count: 27,
      parameters: [parameter("scale", 4e-5), parameter("shape", 0.8)],
      ks: 0.1,
      p_value: 0.5,
      log_likelihood: 305,
      aic: -606,
      above: null,
    },
    {
      law: "power_law",
      of: "volume",
      count: 20,
      parameters: [parameter("exponent", 2), parameter("above", 1.5e-5)],
      ks: 0.1,
      p_value: 0.3,
      log_likelihood: 200,
      aic: null,
      above: 1.5e-5,
    },
  ],
  fits_note: "A note on the fits.",
  per_fracture: [{ time: 1 / 12, body: "ball", new: 27, median_volume: 2e-6, largest_share: 0.2 }],
  energy: { kinetic_start: 9, kinetic_end: 2, fracture: 0.3, lost_in_fractures: 5 },
};

test("statistics are drawn where there are any, and missed where there are none", async () => {
  const without = await variant("plain", { report: ({ statistics, ...rest }) => rest });
  const plain = await openPage(browser, without);
  const text = (page) => page.$eval("#chart-grid", (grid) => grid.textContent);
  assert.match(await text(plain.page), /holds no statistics: no laws are fitted/);
  assert.equal((await plain.page.$$("#chart-grid path.law")).length, 0);
  assert.deepEqual(plain.complaints, []);

  const full = await variant("fitted", { report: (report) => ({ ...report, statistics: STATISTICS }) });
  const { page, complaints } = await openPage(browser, full);
  assert.match(await text(page), /Weibull has the lowest AIC\. A note on the fits\./);
  assert.equal((await page.$$("#chart-grid path.law")).length, 3);
  await page.click(".chart-legend input");
  assert.equal((await page.$$("#chart-grid path.law")).length, 2);
  await page.click("#chart-grid .chart-legend ~ details summary");
  await page.waitForSelector("#chart-grid .chart-legend ~ details tbody tr");
  assert.equal((await page.$$("#chart-grid .chart-legend ~ details tbody tr")).length, 3);
  assert.match(await page.$eval("#run-facts", (facts) => facts.textContent), /Motion lost in fractures5 J/);
  assert.deepEqual(complaints, []);
});

test("a report of another version loses the parts that it lacks only", async () => {
  const address = await variant("other", { report: ({ effects, motion, ...rest }) => rest });
  const { page } = await openPage(browser, address);
  assert.match(await page.$eval("#chart-grid", (grid) => grid.textContent), /This part cannot be shown/);
  assert.ok((await page.$$("#chart-grid figure")).length >= 3);
  assert.equal(await state(page, "mode"), "fragment");
});
