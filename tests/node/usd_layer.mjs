// What TinyUSDZ, a USD implementation of its own, reads from a USDA file: node usd_layer.mjs FILE.usda. Prints {"error", "layer"}: the
// layer as it writes it back, with every value parsed by its type.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

// Its module is built for browsers and looks for one before it starts; it needs nothing of it.
globalThis.window = globalThis;
process.type = 'renderer';
const { default: createTinyUsdz } = await import('tinyusdz/tinyusdz.js');
const wasmBinary = readFileSync(createRequire(import.meta.url).resolve('tinyusdz/tinyusdz.wasm'));
const { TinyUSDZLoaderNative } = await createTinyUsdz({ wasmBinary });

const loader = new TinyUSDZLoaderNative();
const read = loader.loadAsLayerFromBinary(readFileSync(process.argv[2]), process.argv[2]);
console.log(JSON.stringify({ error: read ? '' : loader.error(), layer: read ? loader.layerToString() : '' }));
