// Colours of pieces and of numbers. Linear RGB for the viewer, CSS for legends.

const to255 = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

const linear = (byte) => {
  const c = byte / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
};

/** OKLCH to linear sRGB (Ottosson, "A perceptual color space for image processing", 2020), cut to [0, 1]. */
export function oklch(lightness, chroma, degrees) {
  const a = chroma * Math.cos((degrees * Math.PI) / 180);
  const b = chroma * Math.sin((degrees * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((c) => Math.min(1, Math.max(0, c)));
}

// Perceptually even and readable with every colour vision: matplotlib's viridis and plasma at nine even steps.
const RAMPS = {
  damage: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
  speed: ["#0d0887", "#4b03a1", "#7d03a8", "#a82296", "#cb4679", "#e56b5d", "#f89441", "#fdc328", "#f0f921"],
};

export const rampCss = (name) => `linear-gradient(to right, ${RAMPS[name].join(", ")})`;

/** 256 colours of a ramp, four bytes of sRGB each, as a texture wants them. */
export function rampBytes(name) {
  const stops = RAMPS[name].map(to255);
  const bytes = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1);
    const stop = Math.min(Math.floor(at), stops.length - 2);
    for (let k = 0; k < 3; ++k) bytes[4 * i + k] = stops[stop][k] + (at - stop) * (stops[stop + 1][k] - stops[stop][k]);
    bytes[4 * i + 3] = 255;
  }
  return bytes;
}

/** The same 256 colours in linear RGB. */
export function rampLinear(name) {
  const bytes = rampBytes(name);
  return Array.from({ length: 256 }, (_, i) => [0, 1, 2].map((k) => linear(bytes[4 * i + k])));
}

const WHOLE = { lightness: 0.72, chroma: 0.012, hue: 250 };
const GOLDEN_ANGLE = 137.508;
// Neighbouring ids differ in hue and, for eyes that see few hues, in lightness.
const LIGHTNESS = [0.72, 0.62, 0.8];

const fragmentTone = (piece) =>
  piece.parent < 0 ? WHOLE : { lightness: LIGHTNESS[piece.id % 3], chroma: 0.1, hue: (piece.id * GOLDEN_ANGLE) % 360 };

const GENERATIONS = [
  WHOLE,
  { lightness: 0.66, chroma: 0.12, hue: 240 },
  { lightness: 0.78, chroma: 0.14, hue: 75 },
  { lightness: 0.64, chroma: 0.14, hue: 160 },
  { lightness: 0.62, chroma: 0.17, hue: 30 },
  { lightness: 0.58, chroma: 0.15, hue: 310 },
];
const generationTone = (generation) => GENERATIONS[Math.min(generation, GENERATIONS.length - 1)];

const rgb = ({ lightness, chroma, hue }) => oklch(lightness, chroma, hue);
const css = ({ lightness, chroma, hue }) => `oklch(${lightness} ${chroma} ${hue.toFixed(1)})`;

export const fragmentColour = (piece) => rgb(fragmentTone(piece));
export const generationColour = (piece) => rgb(generationTone(piece.generation));
export const generationCss = (generation) => css(generationTone(generation));
/** From this generation on all have one colour. */
export const lastGeneration = GENERATIONS.length - 1;
