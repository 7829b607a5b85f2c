// Where ramps begin and end, so that a few outliers do not take all of their colours.

const SAMPLES = 20000;

/** The value below which a share of the numbers lie; of many numbers, of an even sample of them. */
function quantile(values, share) {
  const step = Math.max(1, Math.floor(values.length / SAMPLES));
  const sample = [];
  for (let i = 0; i < values.length; i += step) sample.push(values[i]);
  sample.sort((a, b) => a - b);
  return sample[Math.min(sample.length - 1, Math.floor(share * sample.length))];
}

/** { low, high } of most of the known damage times [s], or null when there are none. */
export function damageRange(damage) {
  const known = damage.filter((t) => t >= 0);
  if (known.length === 0) return null;
  const low = quantile(known, 0.01);
  return { low, high: Math.max(quantile(known, 0.99), low + 1e-12) };
}

/** Speed that nearly all fragments stay below in nearly all frames [m/s]; without fragments, of all pieces. */
export function usualTopSpeed(pieces) {
  const fragments = pieces.filter((piece) => piece.parent >= 0);
  const speeds = [];
  for (const { track } of fragments.length > 0 ? fragments : pieces) {
    const { times, values } = track.translation;
    if (!times) continue;
    for (let i = 1; i < times.length; ++i) {
      const at = 3 * i;
      const way = Math.hypot(
        values[at] - values[at - 3],
        values[at + 1] - values[at - 2],
        values[at + 2] - values[at - 1],
      );
      speeds.push(way / (times[i] - times[i - 1]));
    }
  }
  return speeds.length === 0 ? 0 : quantile(speeds, 0.98);
}
