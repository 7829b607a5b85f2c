// What the program wrote into the page (pipeline/report_page.h).

const text = (id) => document.getElementById(id).textContent;

export const readReport = () => JSON.parse(text("report"));

/** The scene file; empty when the run kept none. */
export const readScene = () => text("scene").replaceAll("&lt;", "<").replaceAll("&amp;", "&");

/** `bytes`: fragments.glb, or null when it is not in the page; `size`: of the file, 0 when the run wrote none. */
export function readGeometry() {
  const size = Number(document.getElementById("geometry").dataset.bytes);
  const encoded = text("geometry");
  return { size, bytes: encoded ? fromBase64(encoded) : null };
}

function fromBase64(encoded) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(encoded);
  const binary = atob(encoded);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}
