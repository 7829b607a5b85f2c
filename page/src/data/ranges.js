// Where ramps begin and end, so that a few outliers do not take all of their colours.

/** Of many numbers an even sample of about so many decides. */
const SAMPLES = 20000;

const strideOf = (count) => Math.max(1, Math.floor(count / SAMPLES));

/** The value below which a share of the numbers lie. */
function quantile(values, share) {
  values.sort((a, b) => a - b);
  return values[Math.min(values.length - 1, Math.floor(share * values.length))];
}

/** { low, high } of most of the known damage times [s], or null when there are none. */
export function damageRange(damage) {
  const known = [];
  for (let i = 0, stride = strideOf(damage.length); i < damage.length; i += stride)
    if (damage[i] >= 0) known.push(damage[i]);
  if (known.length === 0) return null;
  const low = quantile(known, 0.01);
  return { low, high: Math.max(quantile(known, 0.99), low + 1e-12) };
}

/** Speed that nearly all fragments stay below in nearly all frames [m/s]; without fragments, of all pieces. */
export function usualTopSpeed(pieces) {
  const fragments = pieces.filter((piece) => piece.parent >= 0);
  const tracks = (fragments.length > 0 ? fragments : pieces).map((piece) => piece.track.translation);
  const moving = tracks.filter(({ times }) => times?.length > 1);
  const stride = strideOf(moving.reduce((sum, { times }) => sum + times.length, 0));
  const speeds = [];
  for (const { times, values } of moving) {
    for (let i = 1; i < times.length; i += stride) {
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
