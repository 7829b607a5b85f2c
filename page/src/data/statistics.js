// Statistics of the fragments: the report's, and what can be told without them.

/** Volumes in ascending order [m³]. */
export const sortedVolumes = (report) => report.fragments.list.map((f) => f.volume).sort((a, b) => a - b);

/** Of ascending numbers; the mean of the middle two where there is no middle one. */
export const median = (sorted) => (sorted[(sorted.length - 1) >> 1] + sorted[sorted.length >> 1]) / 2;

/**
 * Fragments over time: [{ time, body, fresh, alive }], `alive` of that body. Without statistics only those that exist
 * at the end are known, by when they were born.
 */
export function countEvents(report) {
  if (report.statistics?.counts)
    return report.statistics.counts.map((c) => ({ time: c.time, body: c.body, fresh: c.new, alive: c.alive }));
  const events = new Map();
  for (const { birth_time: time, body } of report.fragments.list) {
    const key = `${time} ${body}`;
    const event = events.get(key) ?? { time, body, fresh: 0 };
    ++event.fresh;
    events.set(key, event);
  }
  const alive = new Map();
  return [...events.values()]
    .sort((a, b) => a.time - b.time)
    .map((event) => {
      alive.set(event.body, (alive.get(event.body) ?? 0) + event.fresh);
      return { ...event, alive: alive.get(event.body) };
    });
}

/** Steps of all bodies together: [{ time, alive, changes: events of that time }]. */
export function totalCounts(events) {
  const alive = new Map();
  const steps = [];
  for (const event of events) {
    alive.set(event.body, event.alive);
    const total = [...alive.values()].reduce((sum, n) => sum + n, 0);
    if (steps.at(-1)?.time === event.time) {
      steps.at(-1).alive = total;
      steps.at(-1).changes.push(event);
    } else {
      steps.push({ time: event.time, alive: total, changes: [event] });
    }
  }
  return steps;
}

/** Largest fragment's share of the volume of all. */
export function largestShare(report) {
  if (report.statistics) return report.statistics.largest_share;
  const volumes = sortedVolumes(report);
  return volumes.length === 0 ? NaN : volumes.at(-1) / volumes.reduce((sum, v) => sum + v, 0);
}
