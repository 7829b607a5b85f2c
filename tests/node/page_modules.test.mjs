// The parts of the report page that need no browser.
import assert from "node:assert/strict";
import { test } from "node:test";

const source = new URL("../page/src/", import.meta.url);
const load = (path) => import(new URL(path, source));
const { parseGlb } = await load("data/glb.js");
const { locate, Moment, speedAt, writePose } = await load("data/tracks.js");
const { mergePieces, keyOf } = await load("data/merge.js");
const { posesAt, readPieces } = await load("data/pieces.js");
const { bestFit, survivalOf } = await load("data/laws.js");
const { groundHeight, tokens } = await load("data/scene_text.js");
const { countEvents, totalCounts } = await load("data/statistics.js");
const { explode } = await load("viewer/explode.js");
const { spheresOf, placeOf } = await load("viewer/framing.js");
const { evenTicks, logTicks, logarithmic } = await load("charts/scales.js");
const { rampBytes, oklch } = await load("viewer/colours.js");
const format = await load("format.js");

// A binary glTF of a description and a list of typed arrays, each a buffer view of its own.
function glbOf(document, arrays) {
  let length = 0;
  document.bufferViews = arrays.map((array) => {
    const view = { buffer: 0, byteOffset: length, byteLength: array.byteLength };
    length += Math.ceil(array.byteLength / 4) * 4;
    return view;
  });
  document.buffers = [{ byteLength: length }];
  const json = new TextEncoder().encode(JSON.stringify(document).padEnd(4096));
  const bytes = new Uint8Array(28 + json.length + length);
  const view = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.length, json.length, 0x4e4f534a].forEach((word, i) => view.setUint32(4 * i, word, true));
  bytes.set(json, 20);
  view.setUint32(20 + json.length, length, true);
  view.setUint32(24 + json.length, 0x004e4942, true);
  arrays.forEach((array, i) =>
    bytes.set(new Uint8Array(array.buffer), 28 + json.length + document.bufferViews[i].byteOffset),
  );
  return bytes;
}

const FLOAT = 5126;
const SHORT = 5123;

// A whole body that breaks at 1 s into a fragment, which moves along x at 2 m/s: a cube's corner of three faces, the first
// of them outside.
function broken() {
  const corner = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
  const accessor = (view, type, count, component = FLOAT, more = {}) => ({
    bufferView: view,
    componentType: component,
    type,
    count,
    ...more,
  });
  const box = { min: [0, 0, 0], max: [1, 1, 1] };
  const primitive = (indices, material, more = {}) => ({ attributes: { POSITION: 0, ...more }, indices, material });
  const channel = (sampler, node, path) => ({ sampler, target: { node, path } });
  return glbOf(
    {
      nodes: [
        { name: "cup", mesh: 0, extras: { id: 0, body: "cup", parent: -1, death_time: 1 } },
        { name: "cup_0001", mesh: 1, extras: { id: 1, body: "cup", parent: 0, generation: 1, birth_time: 1 } },
      ],
      meshes: [
        { primitives: [primitive(1, 0)] },
        { primitives: [primitive(1, 0), primitive(2, 1, { _DAMAGE_TIME: 3 })] },
      ],
      materials: [{ name: "clay_outside" }, { name: "clay_inside" }],
      accessors: [
        accessor(0, "VEC3", 4, FLOAT, box),
        accessor(1, "SCALAR", 3, SHORT),
        accessor(2, "SCALAR", 6, SHORT),
        accessor(3, "SCALAR", 4),
        accessor(4, "SCALAR", 3),
        accessor(5, "VEC3", 3),
        accessor(6, "SCALAR", 2),
        accessor(7, "VEC3", 2),
        accessor(8, "VEC3", 2),
      ],
      animations: [
        {
          samplers: [
            { input: 4, output: 5, interpolation: "LINEAR" },
            { input: 6, output: 7, interpolation: "STEP" },
            { input: 6, output: 8, interpolation: "STEP" },
          ],
          channels: [channel(0, 1, "translation"), channel(1, 1, "scale"), channel(2, 0, "scale")],
        },
      ],
    },
    [
      corner,
      Uint16Array.of(0, 2, 1),
      Uint16Array.of(0, 1, 3, 0, 3, 2),
      Float32Array.of(0, 1e-5, 2e-5, 3e-5),
      Float32Array.of(1, 2, 3),
      Float32Array.of(0, 0, 0, 2, 0, 0, 4, 0, 0),
      Float32Array.of(0, 1),
      Float32Array.of(0, 0, 0, 1, 1, 1),
      Float32Array.of(1, 1, 1, 0, 0, 0),
    ],
  );
}

test("a file that is no binary glTF, or needs an extension, is refused by name", () => {
  assert.throws(() => parseGlb(new TextEncoder().encode("<html>".repeat(10))), /no binary glTF/);
  assert.throws(() => parseGlb(glbOf({ extensionsRequired: ["EXT_meshopt_compression"] }, [])), /EXT_meshopt/);
});

test("values that lie apart in the file are brought together", () => {
  const bytes = glbOf({ accessors: [{ bufferView: 0, componentType: FLOAT, type: "VEC3", count: 2 }] }, [
    Float32Array.of(1, 2, 3, 99, 4, 5, 6, 99),
  ]);
  const glb = parseGlb(bytes);
  glb.document.bufferViews[0].byteStride = 16;
  assert.deepEqual([...glb.values(0)], [1, 2, 3, 4, 5, 6]);
  assert.equal(glb.values(0), glb.values(0));
});

test("pieces exist from birth to death and stand between frames where glTF says", () => {
  const glb = parseGlb(broken());
  const pieces = readPieces(glb);
  assert.deepEqual(
    pieces.map((p) => [p.name, p.parent, p.generation, p.death]),
    [
      ["cup", -1, 0, 1],
      ["cup_0001", 0, 1, Infinity],
    ],
  );
  const visible = (time) => [...posesAt(pieces, time)].filter((_, i) => i % 8 === 3);
  assert.deepEqual(visible(0.5), [1, 0]);
  assert.deepEqual(visible(1), [0, 1]);
  assert.deepEqual([...posesAt(pieces, 1.75)].slice(8, 11), [1.5, 0, 0]);
  assert.equal(speedAt(pieces[1].track, new Moment(1.75)), 2);
  assert.equal(speedAt(pieces[1].track, new Moment(3)), 2);
  assert.equal(speedAt(pieces[0].track, new Moment(0.5)), 0);
});

test("what comes to rest has no speed, however far apart its keys are", () => {
  const times = [0, 1, 2, 100];
  const translation = { times, values: Float32Array.of(0, 0, 0, 3, 0, 0, 6, 0, 4, 6, 0, 4), step: false };
  const speed = (time) => speedAt({ translation }, new Moment(time));
  assert.equal(speed(0.5), 3);
  assert.equal(speed(1.5), 5);
  assert.equal(speed(1), Math.hypot(3, 0, 2));
  assert.equal(speed(2), 2.5);
  assert.equal(speed(50), 0);
});

test("a moment lies where it belongs among times that are not even", () => {
  const times = [0, 1, 4, 4.5];
  assert.deepEqual(locate(times, -1), { index: 0, share: 0 });
  assert.deepEqual(locate(times, 0.25), { index: 0, share: 0.25 });
  assert.deepEqual(locate(times, 1), { index: 1, share: 0 });
  assert.deepEqual(locate(times, 2.5), { index: 1, share: 0.5 });
  assert.deepEqual(locate(times, 9), { index: 3, share: 0 });
});

test("rotations between frames have unit length", () => {
  const still = { times: null, values: Float32Array.of(0, 0, 0), step: true };
  const half = Math.SQRT1_2;
  const track = {
    translation: still,
    rotation: { times: [0, 1], values: Float32Array.of(0, 0, 0, 1, 0, 0, half, half), step: false },
    scale: { ...still, values: Float32Array.of(1, 1, 1) },
  };
  const out = new Float32Array(8);
  writePose(track, new Moment(0.5), out, 0);
  // Halfway through a quarter turn about z.
  const expected = [0, 0, Math.sin(Math.PI / 8), Math.cos(Math.PI / 8)];
  expected.forEach((x, k) => assert.ok(Math.abs(out[4 + k] - x) < 1e-6));
});

test("the merged mesh keeps every face with its piece, material and side, and hides as one run", () => {
  const glb = parseGlb(broken());
  const mesh = mergePieces(glb, readPieces(glb));
  const faces = [];
  for (const part of mesh.parts)
    for (let i = part.start; i < part.start + part.count; i += 3)
      faces.push([part.piece, part.brokenOutside, mesh.keys[mesh.indices[i]]]);
  assert.deepEqual(faces, [
    [1, true, keyOf(1, 0, false)],
    [0, false, keyOf(0, 0, false)],
    [1, false, keyOf(1, 1, true)],
    [1, false, keyOf(1, 1, true)],
  ]);
  assert.equal(mesh.indices.length, 12);
  // Three vertices of an outside face twice, four of the inside: nothing that no face uses.
  assert.equal(mesh.keys.length, 10);
  const inside = [...mesh.damage].filter((t) => t >= 0);
  assert.deepEqual(inside.map((t) => Math.round(1e5 * t)).sort(), [0, 1, 2, 3]);
  // The outside face points along -z and is even, crack faces are shaded flat.
  const outside = mesh.indices[0];
  assert.deepEqual([...mesh.normals.subarray(4 * outside, 4 * outside + 4)], [0, 0, -127, 127]);
  const crack = mesh.indices.at(-1);
  assert.equal(mesh.normals[4 * crack + 3], 0);
});

test("fragments move apart from the foot of their body and bodies stay", () => {
  const glb = parseGlb(broken());
  const pieces = readPieces(glb);
  const spheres = spheresOf(glb, pieces);
  const poses = posesAt(pieces, 2);
  pieces.push({ ...pieces[1], index: 2 });
  spheres.push(spheres[1]);
  const two = Float32Array.of(...poses, ...poses.subarray(8));
  two[16] += 3;
  two[17] += 1;
  const before = [1, 2].map((i) => placeOf(two, i, spheres[i].centre));
  const body = [...two.subarray(0, 8)];
  explode(pieces, spheres, two, 0.5);
  const after = [1, 2].map((i) => placeOf(two, i, spheres[i].centre));
  const apart = ([a, b]) => b.map((x, k) => x - a[k]);
  apart(after).forEach((x, k) => assert.ok(Math.abs(x - 1.5 * apart(before)[k]) < 1e-6));
  assert.equal(after[0][1], before[0][1]);
  assert.deepEqual([...two.subarray(0, 8)], body);
});

test("laws give their medians and nothing for a law that is unknown", () => {
  const fit = (law, values, above = null) =>
    survivalOf({ law, above, parameters: Object.entries(values).map(([name, value]) => ({ name, value })) });
  const half = (survival, v) => assert.ok(Math.abs(survival(v) - 0.5) < 1e-6);
  half(fit("mott_2d", { mu: 2 }), 2 * Math.log(2) ** 2);
  half(fit("mott_3d", { mu: 2 }), 2 * Math.log(2) ** 3);
  half(fit("weibull", { scale: 3, shape: 0.7 }), 3 * Math.log(2) ** (1 / 0.7));
  half(fit("log_normal", { mu: -14, sigma: 1.3 }), Math.exp(-14));
  half(fit("gaudin_schuhmann", { maximum: 4, exponent: 0.5 }), 1);
  half(fit("power_law", { exponent: 3, above: 2 }, 2), 2 * Math.SQRT2);
  // One standard deviation above the median of a log-normal law.
  assert.ok(Math.abs(fit("log_normal", { mu: 0, sigma: 1 })(Math.E) - 0.1586553) < 1e-6);
  assert.equal(survivalOf({ law: "new_law", parameters: [] }), null);
  assert.equal(bestFit([{ aic: 3 }, { aic: -7 }, { aic: null }]).aic, -7);
  assert.equal(bestFit([{ aic: null }]), null);
});

test("counts of bodies add up, with statistics and without", () => {
  const statistics = {
    counts: [
      { time: 1, body: "a", new: 3, alive: 3 },
      { time: 1, body: "b", new: 2, alive: 2 },
      { time: 2, body: "a", new: 4, alive: 6 },
    ],
  };
  const alive = (report) => totalCounts(countEvents(report)).map((step) => [step.time, step.alive]);
  assert.deepEqual(alive({ statistics }), [
    [1, 5],
    [2, 8],
  ]);
  const list = [2, 1, 1].map((birth_time) => ({ birth_time, body: "a" }));
  assert.deepEqual(alive({ fragments: { list } }), [
    [1, 2],
    [2, 3],
  ]);
});

test("the floor is read from its section only", () => {
  assert.equal(groundHeight("[scene]\nheight = 3\n"), null);
  assert.equal(groundHeight("[ground]\n[[body]]\nheight = 3\n"), 0);
  assert.equal(groundHeight('[[body]]\nheight = 1\n[ground]\nmaterial = "stone"\nheight = -0.5 # low\n'), -0.5);
});

test("a line of TOML is coloured without losing a letter", () => {
  const lines = ["", "# all", "[ground] # floor", 'name = "a # b" # c', "  { time = 0.0, position = [0, 1, 0] },", "x"];
  for (const line of lines)
    assert.equal(
      tokens(line)
        .map((t) => t.text)
        .join(""),
      line,
    );
  assert.deepEqual(
    tokens('name = "a # b" # c').map((t) => t.kind),
    ["key", "value", "comment"],
  );
});

test("numbers are told with three digits in the unit that fits", () => {
  assert.equal(format.volume(5.263e-5), "52.6 cm³");
  assert.equal(format.time(0.0041666), "4.17 ms");
  assert.equal(format.time(0), "0 s");
  assert.equal(format.memory(0), "0 kB");
  assert.equal(format.number(3.954e-16, 2), "4 × 10⁻¹⁶");
  assert.equal(format.number(-0.25), "−0.25");
  assert.equal(format.count(9859314), "9\u202f859\u202f314");
  assert.equal(format.percent(0.17), "17 %");
  assert.equal(format.speed(null), "–");
  assert.equal(format.counted(1, "fragment"), "1 fragment");
});

test("ticks are round and within the axis", () => {
  assert.deepEqual(evenTicks([0, 1.05], 5), [0, 0.5, 1]);
  assert.deepEqual(evenTicks([0, 24], 5), [0, 5, 10, 15, 20]);
  assert.deepEqual(
    logTicks([0.05, 200]).map((x) => Math.round(Math.log10(x))),
    [-1, 0, 1, 2],
  );
  assert.deepEqual(logTicks([15, 80]).map(Math.round), [20, 50]);
  assert.equal(logarithmic([1, 100], [0, 50])(10), 25);
});

test("colours are what their names say", () => {
  const bytes = rampBytes("damage");
  assert.deepEqual([...bytes.subarray(0, 3)], [0x44, 0x01, 0x54]);
  assert.deepEqual([...bytes.subarray(4 * 255, 4 * 255 + 3)], [0xfd, 0xe7, 0x25]);
  oklch(1, 0, 0).forEach((c) => assert.ok(Math.abs(c - 1) < 1e-6));
  // sRGB red is oklch(0.62796 0.25768 29.234).
  [1, 0, 0].forEach((c, k) => assert.ok(Math.abs(oklch(0.62796, 0.25768, 29.234)[k] - c) < 1e-3));
});
