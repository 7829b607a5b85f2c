// What three.js reads from a USDA file: node usd_tree.mjs FILE.usda. Prints [{"name", "type", "vertices", "groups"}, ...] of all objects.
import { readFileSync } from 'node:fs';
import { USDLoader } from 'three/addons/loaders/USDLoader.js';

const group = new USDLoader().parse(readFileSync(process.argv[2], 'utf8'));
const objects = [];
group.traverse((object) => {
  const geometry = object.geometry;
  objects.push({
    name: object.name,
    type: object.type,
    vertices: geometry ? geometry.attributes.position.count : 0,
    uv: Boolean(geometry?.attributes.uv),
    up: object.up.toArray(),
  });
});
console.log(JSON.stringify(objects));
