// How soon the report page answers. SUNDER_PAGE names the folder of an index.html with its fragments.glb; the medians go
// to page_bench.json there [s].
import { readFile, writeFile } from "node:fs/promises";
import { AnimationMixer } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { launch, openPage } from "./browser.mjs";

const folder = process.env.SUNDER_PAGE;
const RUNS = 7;
const SCRUBS = 10;
const page = new URL("../page/src/data/", import.meta.url);
const { parseGlb } = await import(new URL("glb.js", page));
const { mergePieces } = await import(new URL("merge.js", page));
const { posesAt, readPieces } = await import(new URL("pieces.js", page));

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

async function seconds(work) {
  const begin = performance.now();
  await work();
  return (performance.now() - begin) / 1000;
}

// In the page: moves the slider, and waits for the frame after the one that draws it.
const scrub = (frame) =>
  new Promise((done) => {
    const slider = document.getElementById("frame");
    const begin = performance.now();
    slider.value = frame;
    slider.dispatchEvent(new Event("input"));
    requestAnimationFrame(() => requestAnimationFrame(() => done({ begin, end: performance.now() })));
  });

// A browser of its own each time: nothing is compiled or cached yet.
async function opened() {
  const browser = await launch();
  const { page: tab } = await openPage(browser, `file://${folder}/index.html`, { motion: "no-preference" });
  const [first] = await tab.evaluate(() => performance.getEntriesByName("sunder-first-frame").map((m) => m.startTime));
  const { end } = await tab.evaluate(scrub, 120);
  const later = [];
  for (let i = 0; i < SCRUBS; ++i) {
    const moment = await tab.evaluate(scrub, 30 + 20 * i);
    later.push((moment.end - moment.begin) / 1000);
  }
  await browser.close();
  return { first: first / 1000, interactive: end / 1000, scrub: median(later) };
}

async function loaders() {
  const file = await readFile(`${folder}/fragments.glb`);
  const buffer = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
  globalThis.self ??= globalThis;
  const general = async () => {
    const gltf = await new GLTFLoader().parseAsync(buffer, "");
    const mixer = new AnimationMixer(gltf.scene);
    gltf.animations.forEach((clip) => mixer.clipAction(clip).play());
    mixer.setTime(2);
  };
  const own = () => {
    const glb = parseGlb(new Uint8Array(buffer));
    const pieces = readPieces(glb);
    mergePieces(glb, pieces);
    posesAt(pieces, 2);
  };
  const times = { loader: [], decoder: [] };
  for (let i = 0; i < RUNS; ++i) {
    times.loader.push(await seconds(general));
    times.decoder.push(await seconds(own));
  }
  return { loader: median(times.loader), decoder: median(times.decoder) };
}

const runs = [];
for (let i = 0; i < RUNS; ++i) runs.push(await opened());
const of = (key) => median(runs.map((run) => run[key]));
const result = { first_frame: of("first"), interactive: of("interactive"), scrub: of("scrub"), ...(await loaders()) };
await writeFile(`${folder}/page_bench.json`, JSON.stringify(result));
