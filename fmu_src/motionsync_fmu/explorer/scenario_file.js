"use strict";
// A run as a scenario's file.

/** A Real as TOML has it: with all its digits, and never as an integer. */
function written(x) {
  const text = Object.is(x, -0) ? "-0.0" : String(x);
  return /[.e]/.test(text) ? text.replace("e+", "e") : `${text}.0`;
}

const quoted = (text) => JSON.stringify(text);
const key = (name) => (/^[\w-]+$/.test(name) ? name : quoted(name));

/** The value of a variable. */
function valueOf(v, x) {
  if (v.kind === "Boolean") return x ? "true" : "false";
  if (v.choices.length) return quoted(v.choices.find(([n]) => n === x)?.[1] ?? "");
  return v.kind === "Real" ? written(x) : String(x);
}

/** The file of a scenario of a block; `variables`: those of the block, by name; `comments`: comments at its beginning. */
function toml(scenario, block, variables, comments) {
  const rows = (values) =>
    Object.entries(values).map(
      ([name, x]) => `${key(name)} = ${x === "cuts.length" ? quoted(x) : valueOf(variables.get(name), x)}`,
    );
  const braces = (values) => `{ ${rows(values).join(", ")} }`;
  const lines = [...comments.map((comment) => `# ${comment}`), `title = ${quoted(scenario.title)}`];
  if (scenario.source) lines.push(`source = ${quoted(scenario.source)}`);
  lines.push(`fmu = ${quoted(block.name)}`, `unit = ${quoted(scenario.unit)}`);
  if (scenario.slave_unit) lines.push(`slave_unit = ${quoted(scenario.slave_unit)}`);
  lines.push(`stop_time = ${written(scenario.stop_time)}`, `step_size = ${written(scenario.step_size)}`);
  if (scenario.step_bound) lines.push(`step_bound = ${quoted(scenario.step_bound)}`);
  if (Object.keys(scenario.interface).length) {
    lines.push(
      "",
      "[interface]",
      ...Object.entries(scenario.interface).map(([name, patterns]) => `${name} = ${JSON.stringify(patterns)}`),
    );
  }
  lines.push("", "[start]", ...rows(scenario.start), "", ...axisTable(scenario), ...encoderLines(scenario, block.ideal_encoder));
  for (const s of [...scenario.settings].sort((a, b) => a.at - b.at))
    lines.push("", "[[set]]", `at = ${written(s.at)}`, ...rows(s.values));
  for (const r of scenario.reactions) {
    lines.push("", "[[on]]", `when = ${quoted(conditionOf(r, variables.get(r.name)))}`);
    if (r.after) lines.push(`after = ${written(r.after)}`);
    if (Object.keys(r.set).length) lines.push(`set = ${braces(r.set)}`);
    if (Object.keys(r.add).length) lines.push(`add = ${braces(r.add)}`);
    lines.push(r.times === null ? "repeat = true" : `times = ${r.times}`);
    if (r.required) lines.push("required = true");
  }
  if (Object.keys(scenario.cuts).length) {
    lines.push(
      "",
      "[cuts]",
      ...Object.entries(scenario.cuts).map(
        ([name, x]) => `${name} = ${typeof x === "string" ? quoted(x) : written(x)}`,
      ),
    );
  }
  return `${lines.join("\n")}\n`;
}

/** The condition as the file had it, but for a value that was changed. */
function conditionOf(r, v) {
  return r.value === r.first ? r.when : `${r.name} ${r.comparison} ${valueOf(v, r.value)}`;
}

/** The table [encoder]: what differs from an encoder that is ideal. */
function encoderLines({encoder, axis}, ideal) {
  if (!encoder || axis.times) return [];
  const {runout_amplitude: amplitude, runout_length: length, seed, ...others} = encoder;
  const given = Object.entries(others).filter(([name, x]) => x !== ideal[name]);
  const lines = ["", "[encoder]", ...given.map(([name, x]) => `${name} = ${written(x)}`)];
  if (amplitude) lines.push(`runout = { amplitude = ${written(amplitude)}, length = ${written(length)} }`);
  if (seed) lines.push(`seed = ${seed}`);
  return lines;
}

function axisTable({axis, drive, remote}) {
  if (axis.times) return ["[master]", `file = "trace.csv" # the file of the scenario`];
  const lines = [
    remote ? "[remote]" : "[master]",
    ...MOTION.filter((name) => name in axis).map((name) => `${name} = ${written(axis[name])}`),
  ];
  if (axis.segments?.length) {
    const table = (segment) =>
      `    { ${Object.entries(segment)
        .map(([name, x]) => `${name} = ${written(x)}`)
        .join(", ")} },`;
    lines.push("segments = [", ...axis.segments.map(table), "]");
  }
  if (drive) {
    lines.push(`follows = ${quoted(drive.follows)}`, `time_constant = ${written(drive.time_constant)}`);
    if (drive.max_acceleration !== null) lines.push(`max_acceleration = ${written(drive.max_acceleration)}`);
  }
  if (remote) {
    const rates = remote.rates.map(({at, cycle}) => `{ at = ${written(at)}, cycle = ${written(cycle)} }`);
    lines.push(`sender_cycle = ${rates.length > 1 ? `[${rates.join(", ")}]` : written(remote.rates[0].cycle)}`);
    lines.push(`phase = ${written(remote.phase)}`, `jitter = ${written(remote.jitter)}`, `seed = ${remote.seed}`);
    lines.push(`lost = ${JSON.stringify(remote.lost)}`, `first_index = ${remote.first_index}`);
  }
  return lines;
}
