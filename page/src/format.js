// Numbers as people read them: three digits, the unit that fits, thin spaces between thousands.

const NARROW = "\u202f";
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

const grouped = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });

export const count = (n) => grouped.format(n).replaceAll(",", NARROW);

const superscript = (n) =>
  (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((digit) => SUPERSCRIPTS[Number(digit)]).join("");

/** To `digits` significant digits; far from 1 as a power of ten. */
export function number(x, digits = 3) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-3) {
    const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
    return `${String(Number(mantissa)).replace("-", "−")} × 10${superscript(Number(exponent))}`;
  }
  if (size >= 10 ** digits) return count(x).replace("-", "−");
  return String(Number(x.toPrecision(digits))).replace("-", "−");
}

// Units from large to small: the first that leaves a number of at least one.
function withUnit(x, units) {
  if (x === null || x === undefined || !Number.isFinite(x)) return number(x);
  const size = x === 0 ? 1 : Math.abs(x);
  const [factor, name] = units.find(([least]) => size >= least) ?? units.at(-1);
  return `${number(x / factor)} ${name}`;
}

const UNITS = {
  time: [
    [60, "min"],
    [1, "s"],
    [1e-3, "ms"],
    [1e-6, "µs"],
    [1e-9, "ns"],
  ],
  length: [
    [1, "m"],
    [1e-2, "cm"],
    [1e-3, "mm"],
    [1e-6, "µm"],
  ],
  area: [
    [1, "m²"],
    [1e-4, "cm²"],
    [1e-6, "mm²"],
  ],
  volume: [
    [1, "m³"],
    [1e-3, "dm³"],
    [1e-6, "cm³"],
    [1e-9, "mm³"],
    [1e-18, "µm³"],
  ],
  mass: [
    [1e3, "t"],
    [1, "kg"],
    [1e-3, "g"],
    [1e-6, "mg"],
  ],
  speed: [
    [1, "m/s"],
    [1e-3, "mm/s"],
  ],
  energy: [
    [1e6, "MJ"],
    [1e3, "kJ"],
    [1, "J"],
    [1e-3, "mJ"],
    [1e-6, "µJ"],
  ],
  impulse: [
    [1, "N s"],
    [1e-3, "mN s"],
  ],
  pressure: [
    [1e9, "GPa"],
    [1e6, "MPa"],
    [1e3, "kPa"],
    [1, "Pa"],
  ],
  memory: [
    [1e9, "GB"],
    [1e6, "MB"],
    [1e3, "kB"],
  ],
};

export const time = (x) => withUnit(x, UNITS.time);
export const length = (x) => withUnit(x, UNITS.length);
export const area = (x) => withUnit(x, UNITS.area);
export const volume = (x) => withUnit(x, UNITS.volume);
export const mass = (x) => withUnit(x, UNITS.mass);
export const speed = (x) => withUnit(x, UNITS.speed);
export const energy = (x) => withUnit(x, UNITS.energy);
export const impulse = (x) => withUnit(x, UNITS.impulse);
export const pressure = (x) => withUnit(x, UNITS.pressure);
export const memory = (x) => withUnit(x, UNITS.memory);

/** A share of 1. */
export const percent = (x) => (Number.isFinite(x) ? `${number(100 * x)} %` : number(x));

/** "1 fragment", "12 fragments". */
export const counted = (n, one, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;

/** "volume_error" as words. */
export const words = (key) => key.replaceAll("_", " ");
