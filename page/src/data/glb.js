// Binary glTF 2.0, as far as Sunder writes it: one buffer, no sparse accessors, no extensions. A general loader makes
// an object of every piece and a track of every channel, which for a thousand pieces takes longer than all the rest.

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const COMPONENTS = {
  5120: Int8Array,
  5121: Uint8Array,
  5122: Int16Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
};
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

function chunks(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.byteLength < 20 || view.getUint32(0, true) !== MAGIC) throw new Error("fragments.glb is no binary glTF");
  const length = view.getUint32(12, true);
  if (view.getUint32(16, true) !== JSON_CHUNK) throw new Error("fragments.glb does not begin with its description");
  const document = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  const binary = 28 + length;
  return { document, binary: bytes.byteOffset + Math.min(binary, bytes.byteLength) };
}

// Values that lie apart are brought together.
function gathered(Type, buffer, offset, stride, count, width) {
  const values = new Type(count * width);
  for (let i = 0; i < count; ++i) values.set(new Type(buffer, offset + i * stride, width), i * width);
  return values;
}

/**
 * `document`: the JSON part; `values(index)`: the numbers of an accessor, a view of the file where they lie together.
 * The same index gives the same array.
 */
export function parseGlb(bytes) {
  const { document, binary } = chunks(bytes);
  if (document.extensionsRequired?.length)
    throw new Error(`fragments.glb needs ${document.extensionsRequired.join(", ")}, which this viewer cannot read`);
  const known = new Map();
  const read = (index) => {
    const accessor = document.accessors[index];
    const view = document.bufferViews[accessor.bufferView];
    const Type = COMPONENTS[accessor.componentType];
    const width = WIDTHS[accessor.type];
    const offset = binary + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    const tight = width * Type.BYTES_PER_ELEMENT;
    return (view.byteStride ?? tight) === tight
      ? new Type(bytes.buffer, offset, accessor.count * width)
      : gathered(Type, bytes.buffer, offset, view.byteStride, accessor.count, width);
  };
  const values = (index) => {
    if (!known.has(index)) known.set(index, read(index));
    return known.get(index);
  };
  return { document, values };
}
