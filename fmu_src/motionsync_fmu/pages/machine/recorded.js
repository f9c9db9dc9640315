"use strict";
// Shows the machine of a recording that the page has, from recorded.py.

/** A column from its whole numbers, of each the step from the one before; `scale` of them are a unit. */
function column({scale, steps}) {
  let sum = 0;
  return Float64Array.from(steps, (step) => (sum += step) / scale);
}

unpackedJson(given.textContent, (_, x) => (x?.steps ? column(x) : x)).then(({block, scenario, columns}) => {
  const {time, axes, values} = columns, errors = {time: time.subarray(1), ...columns.errors};
  load(sceneOf({scenario, time, errors, axis: (order) => axes[order], column: (name) => values[name]}, block));
});
