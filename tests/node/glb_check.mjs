// A GLB file as others see it: the Khronos validator, and three.js playing it.
//   node glb_check.mjs FILE.glb EXPECTED.json
// EXPECTED: {"frames": [{"time": t, "pieces": {name: {"position": [...], "orientation": [x, y, z, w]}}}]}. Prints one JSON object:
// {"errors", "warnings", "infos", "hints", "differences": [...]}.
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import { AnimationMixer, LoopOnce } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

// The loader looks for a browser's global name, and there are no pictures in Node: textures stay away.
globalThis.self = globalThis;
console.error = () => {};

const [file, expectedFile] = process.argv.slice(2);
const bytes = new Uint8Array(readFileSync(file));
const { frames } = JSON.parse(readFileSync(expectedFile, 'utf8'));

async function issues() {
  const { numErrors, numWarnings, numInfos, numHints, messages } = (await validator.validateBytes(bytes)).issues;
  return { errors: numErrors, warnings: numWarnings, infos: numInfos, hints: numHints, messages: messages.slice(0, 5) };
}

// Single precision is what the file holds: equal means equal in every bit of it.
function compare(differences, what, found, expected) {
  expected.forEach((value, i) => {
    if (found[i] !== Math.fround(value)) differences.push(`${what}[${i}]: ${found[i]} instead of ${Math.fround(value)}`);
  });
}

function compareFrame(differences, scene, { time, pieces }) {
  for (const node of scene.children) {
    const expected = pieces[node.name];
    const visible = node.scale.x !== 0;
    if (visible !== (expected !== undefined)) differences.push(`${node.name} at ${time} s: visible ${visible}`);
    if (!expected) continue;
    compare(differences, `${node.name} at ${time} s: position`, node.position.toArray(), expected.position);
    const q = node.quaternion.toArray();
    // q and -q are the same rotation.
    const sign = q.reduce((sum, value, i) => sum + value * expected.orientation[i], 0) < 0 ? -1 : 1;
    compare(differences, `${node.name} at ${time} s: orientation`, q, expected.orientation.map((v) => sign * v));
  }
}

async function differences() {
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
  const found = [];
  const mixer = new AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) {
    const action = mixer.clipAction(clip);
    action.setLoop(LoopOnce);
    action.clampWhenFinished = true;
    action.play();
  }
  for (const frame of frames) {
    if (gltf.animations.length > 0) mixer.setTime(Math.fround(frame.time));
    compareFrame(found, gltf.scene, frame);
  }
  return found;
}

console.log(JSON.stringify({ ...(await issues()), differences: await differences() }));
