// The laws that the report fits to fragment volumes: their names, and the share of fragments above a volume. The formulas
// are those of docs/statistics.md.

const names = {
  mott_2d: "Mott 2D",
  mott_3d: "Mott 3D",
  weibull: "Weibull",
  log_normal: "Log-normal",
  gaudin_schuhmann: "Gaudin–Schuhmann",
  power_law: "Power law",
};

/** Abramowitz and Stegun 7.1.26; within 1.5e-7. */
function erfc(x) {
  const t = 1 / (1 + 0.3275911 * Math.abs(x));
  const tail =
    t *
    (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) *
    Math.exp(-x * x);
  return x >= 0 ? tail : 2 - tail;
}

const survivals = {
  mott_2d:
    ({ mu }) =>
    (v) =>
      Math.exp(-((v / mu) ** (1 / 2))),
  mott_3d:
    ({ mu }) =>
    (v) =>
      Math.exp(-((v / mu) ** (1 / 3))),
  weibull:
    ({ scale, shape }) =>
    (v) =>
      Math.exp(-((v / scale) ** shape)),
  log_normal:
    ({ mu, sigma }) =>
    (v) =>
      0.5 * erfc((Math.log(v) - mu) / (sigma * Math.SQRT2)),
  gaudin_schuhmann:
    ({ maximum, exponent }) =>
    (v) =>
      Math.max(0, 1 - (v / maximum) ** exponent),
  power_law:
    ({ exponent, above }) =>
    (v) =>
      v < above ? 1 : (v / above) ** (1 - exponent),
};

export const lawName = (law) => names[law] ?? law;

/** The share of what was fitted that is larger than a volume; null for a law that this page does not know. */
export function survivalOf(fit) {
  const make = survivals[fit.law];
  if (!make) return null;
  return make({ above: fit.above, ...Object.fromEntries(fit.parameters.map(({ name, value }) => [name, value])) });
}

/** The fit with the lowest AIC, null without one. A power law has none: it speaks of a part of the fragments only. */
export const bestFit = (fits) =>
  fits
    .filter((fit) => Number.isFinite(fit.aic) && fit.aic !== null)
    .reduce((best, fit) => (best === null || fit.aic < best.aic ? fit : best), null);
