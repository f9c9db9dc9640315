"use strict";
// The errors of a run with a remote axis.

/** How far telegrams and slave are from the truth, at all points but the first (scenario/remote_view.py). */
function errorsOf(course) {
  const {
      telegrams,
      script,
      scenario: {remote, settings},
    } = course,
    time = course.time.slice(1);
  const slave = course.column("slave.position"), corrected = course.column(remote.corrected_index);
  const later = settings.filter((s) => remote.delay in s.values).map((s) => [s.at, s.values[remote.delay]]);
  const delays = [[0, telegrams.delay], ...later.sort((a, b) => a[0] - b[0])];
  const errors = {time, index: [], corrected_index: [], position: [], corrected_position: []};
  const wrapped = (x) => x - remote.wraps_at * Math.round(x / remote.wraps_at);
  time.forEach((t, i) => {
    const acted = telegrams.acted(t) - 1, instant = acted * telegrams.cycle, index = telegrams.trueIndex(instant);
    const [seen, motion] = telegrams.telegram(telegrams.shown(course.time[i], t));
    const delay = delays.findLast(([at]) => at <= instant + 1e-9)[1];
    errors.index.push(wrapped(seen - index));
    errors.corrected_index.push(wrapped(corrected[i + 1] - index));
    errors.position.push(motion[0] - script.at(instant)[0]);
    errors.corrected_position.push(slave[i + 1] - script.at(instant + delay - remote.behind * telegrams.nominal)[0]);
  });
  return errors;
}
