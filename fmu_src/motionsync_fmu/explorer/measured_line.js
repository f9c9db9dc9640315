"use strict";
// The switch "measured line": which encoder it puts between the master and the block, and what the block makes of that.

const SMOOTHING = "master.smoothing_time";
const RESOLUTION = {mm: 0.05, m: 0.00005}; // of a measuring wheel
const COUNTS = 7200; // of an encoder, in one turn
const FINE = 1e-4; // s: where there is neither wheel nor turn, a count is the line's travel in this time
const NOISE = 0.4; // of a count
const DELAY = 0.002; // s
const UP_TO = 10; // times what is usual: so far go the sliders

/** An encoder as such a line usually has one; `ideal`: one that measures exactly. */
function usualEncoder({unit, start, axis}, ideal) {
  const period = start["master.period"] ?? 0, fastest = furthest(new Script(axis).motions.map(([, velocity]) => velocity));
  const resolution = RESOLUTION[unit] ?? decimal(round((period ? period / COUNTS : FINE * fastest) || RESOLUTION.mm));
  return {...ideal, resolution, noise: decimal(NOISE * resolution), delay: DELAY};
}

/** A short decimal number; products of such numbers are not quite short. */
const decimal = (x) => Number(x.toPrecision(3));

/** What the block makes of a measured line, in words; `variables`: those of the block, by name. */
function takenAs({start, encoder}, variables) {
  const mode = start[INPUT_MODE] ?? MEASURED, [, name] = variables.get(INPUT_MODE).choices.find(([n]) => n === mode);
  if (mode !== MEASURED) return `The block does not smooth it: the start value of ${INPUT_MODE} is ${name}.`;
  const others = Object.entries(OF_ENCODER).filter(([key, own]) => (start[key] ?? encoder[own]) !== encoder[own]);
  const values = others.map(([key]) => `${key} = ${start[key]} s`).join(" and ");
  const instead = values && ` It does so by ${values}, as the start values have it.`;
  return `The block smooths it, and carries it on to the present: ${INPUT_MODE} is ${name}.${instead}`;
}
