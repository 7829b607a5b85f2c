// The report page in a browser. SUNDER_PAGE names the folder of an index.html with 27 shards in 24 frames
// (tests/pipeline/burst.h); screenshots go there, too.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
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
  return createHash("sha256").update(await page.evaluate(() => window.picture)).digest("hex");
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
  for (const [key, mode] of [["0", "material"], ["1", "fragment"], ["2", "generation"], ["3", "damage"], ["4", "speed"]]) {
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
  await moving.page.waitForFunction((frame) => Number(document.getElementById("viewer").dataset.frame) > frame, {}, first);
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

const INTERACTIVE = ["button", "slider", "checkbox", "radio", "combobox", "link", "image", "table", "heading", "group"];

const named = (node) => (node.children ?? []).flatMap(named).concat(INTERACTIVE.includes(node.role) ? [node] : []);

test("everything that can be used or read has a name, and one tab stop leads through each chart", async () => {
  const { page } = await openPage(browser, file);
  const nodes = named(await page.accessibility.snapshot({ interestingOnly: false }));
  assert.ok(nodes.length > 50);
  assert.deepEqual(nodes.filter((node) => !node.name && node.role !== "group"), []);
  const stops = await page.$$eval("#chart-grid .plot", (plots) => plots.map((p) => p.querySelectorAll("[tabindex='0']").length));
  assert.ok(stops.length >= 4);
  assert.deepEqual(new Set(stops), new Set([1]));
  await page.$eval("#chart-grid .plot [tabindex='0']", (mark) => mark.focus());
  const tip = () => page.$eval("#chart-grid .plot:has(:focus) .tooltip", (tooltip) => (tooltip.hidden ? "" : tooltip.textContent));
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
  assert.equal((await page.$$("#fragment-table tbody tr")).length, 25);
  await blind.close();
});
