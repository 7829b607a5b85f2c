// Motion of the pieces: translations, rotations and scales over time, as glTF animates them.

/** `index` of the last of the ascending `times` that is not after `time`, and the `share` of the way to the next. */
export function locate(times, time) {
  let low = 0;
  let high = times.length - 1;
  if (time <= times[0]) return { index: 0, share: 0 };
  if (time >= times[high]) return { index: high, share: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return { index: low, share: (time - times[low]) / (times[high] - times[low]) };
}

const constant = (values) => ({ times: null, values, step: true });

/** The tracks of all nodes of the file: `[{ translation, rotation, scale }]`, each `{ times, values, step }`. */
export function readTracks(glb) {
  const tracks = glb.document.nodes.map((node) => ({
    translation: constant(Float32Array.from(node.translation ?? [0, 0, 0])),
    rotation: constant(Float32Array.from(node.rotation ?? [0, 0, 0, 1])),
    scale: constant(Float32Array.from(node.scale ?? [1, 1, 1])),
  }));
  for (const animation of glb.document.animations ?? []) {
    for (const { sampler, target } of animation.channels) {
      const { input, output, interpolation } = animation.samplers[sampler];
      const track = tracks[target.node];
      if (!track || !(target.path in track)) continue;
      track[target.path] = { times: glb.values(input), values: glb.values(output), step: interpolation === "STEP" };
    }
  }
  return tracks;
}

/** Looks times up once for all tracks that share them. */
export class Moment {
  constructor(time) {
    this.time = time;
    this.found = new Map();
  }

  locate(times) {
    let place = this.found.get(times);
    if (!place) this.found.set(times, (place = locate(times, this.time)));
    return place;
  }
}

function sample(channel, width, moment, out, at) {
  const { values } = channel;
  if (!channel.times) {
    for (let k = 0; k < width; ++k) out[at + k] = values[k];
    return;
  }
  const { index, share } = moment.locate(channel.times);
  const from = index * width;
  if (channel.step || share === 0) {
    for (let k = 0; k < width; ++k) out[at + k] = values[from + k];
  } else {
    for (let k = 0; k < width; ++k)
      out[at + k] = values[from + k] + share * (values[from + width + k] - values[from + k]);
  }
}

function normalise(out, at) {
  const length = Math.hypot(out[at], out[at + 1], out[at + 2], out[at + 3]) || 1;
  for (let k = 0; k < 4; ++k) out[at + k] /= length;
}

const scratch = new Float32Array(3);

/** Writes position and visibility (0 or 1) to `out[at ... at + 3]`, the unit quaternion to the four after it. */
export function writePose(track, moment, out, at) {
  sample(track.translation, 3, moment, out, at);
  sample(track.rotation, 4, moment, out, at + 4);
  // Neighbouring rotations are a frame apart: their straight mean, normalised, is within 1e-4 of the arc.
  normalise(out, at + 4);
  sample(track.scale, 3, moment, scratch, 0);
  out[at + 3] = scratch[0] > 0 ? 1 : 0;
}

// Velocity between key `i` and the next, null where there is none; times may be far apart where nothing moves.
function slope({ times, values }, i, axis) {
  if (i < 0 || i + 1 >= times.length) return null;
  return (values[3 * (i + 1) + axis] - values[3 * i + axis]) / (times[i + 1] - times[i]);
}

/** Speed of the centre of mass [m/s]: that between two keys, at a key the mean of both sides. */
export function speedAt(track, moment) {
  const channel = track.translation;
  if (!channel.times || channel.times.length < 2) return 0;
  const { index, share } = moment.locate(channel.times);
  const velocity = [0, 1, 2].map((axis) => {
    const after = slope(channel, index, axis);
    const before = slope(channel, index - 1, axis);
    if (share > 0 || before === null) return after;
    return after === null ? before : (before + after) / 2;
  });
  return Math.hypot(...velocity);
}
