// From data to pixels, and the round numbers between.

export function linear([low, high], [from, to]) {
  const slope = (to - from) / (high - low || 1);
  return Object.assign((x) => from + (x - low) * slope, { domain: [low, high], range: [from, to] });
}

export function logarithmic([low, high], range) {
  const inner = linear([Math.log10(low), Math.log10(high)], range);
  return Object.assign((x) => inner(Math.log10(x)), { domain: [low, high], range });
}

/** Multiples of 1, 2 or 5 times a power of ten within the bounds, about `wanted` of them. */
export function evenTicks([low, high], wanted = 5) {
  const rough = (high - low) / wanted;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((multiple) => multiple * power >= rough);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(i * step || 0);
  return ticks;
}

/** Powers of ten within the bounds, at most `wanted`; with fewer than three also 2 and 5 times them. */
export function logTicks([low, high], wanted = 8) {
  const first = Math.ceil(Math.log10(low) - 1e-9);
  const last = Math.floor(Math.log10(high) + 1e-9);
  const stride = Math.max(1, Math.ceil((last - first + 1) / wanted));
  const powers = [];
  for (let k = first; k <= last; k += stride) powers.push(10 ** k);
  if (powers.length > 2) return powers;
  const fine = [];
  for (let k = first - 1; k <= last; ++k) fine.push(10 ** k, 2 * 10 ** k, 5 * 10 ** k);
  return fine.filter((x) => x >= low * (1 - 1e-9) && x <= high * (1 + 1e-9));
}
