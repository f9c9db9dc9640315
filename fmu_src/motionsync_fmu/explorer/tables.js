"use strict";
// The tables from which the compiled runner carries a scenario: batch/script_tables.py makes the same ones of a scenario's
// file. What is here follows simulation.py, reactions.py, script.py, clocks.py and encoder_table.py, sum by sum. Numbers that
// have one meaning in all languages come with the page, as `runner`.

const DECIMALS_UNIT = 1e12; // of a scan's time in s: so many of its last decimal are 1 s
const LONG = 8192; // s; from here on, neighbouring numbers are more than a unit of the last decimal apart
const INPUT_MODE = "master.input_mode", END_OF_STEP = 2, MEASURED = 4;
const OF_ENCODER = {"master.delay": "delay", "master.sample_time": "sample_time"}; // what the block has to know of it
const SCALING = "master.encoder_scaling"; // not all blocks have it
const PAGE = 65536; // bytes that memory grows by
const MOTION = ["position", "velocity", "acceleration"]; // of an axis

// --- times ---

/** How many of the sorted `times` are not after t (`right`), or before t. */
function bisect(times, t, right) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (right ? times[middle] <= t : times[middle] < t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The remainder with the sign of the divisor, as Python has it. */
function modulo(x, y) {
  const rest = x % y;
  return rest !== 0 && rest < 0 !== y < 0 ? rest + y : rest;
}

/** Two numbers of half as many bits, whose sum is x (T. J. Dekker 1971). */
function halves(x) {
  const most = 134217729 * x, // 2**27 + 1
    high = most - (most - x);
  return [high, x - high];
}

const [UNIT_HIGH, UNIT_LOW] = halves(DECIMALS_UNIT);

/** A time, at least 0, with 12 decimals, as `round` of Python gives it: the nearest one, and of two the even one. */
function rounded(t) {
  if (!(t < LONG)) return t;
  const units = t * DECIMALS_UNIT, [high, low] = halves(t);
  const error = low * UNIT_LOW - (units - high * UNIT_HIGH - low * UNIT_HIGH - high * UNIT_LOW);
  const below = Math.floor(units), odd = below % 2 === 1;
  const nearest = units - below > 0.5 || (units - below === 0.5 && odd) ? below + 1 : below;
  const above = units - nearest, uneven = nearest % 2 === 1;
  const up = error > 0.5 - above || (error === 0.5 - above && uneven),
    down = error < -0.5 - above || (error === -0.5 - above && uneven);
  return (nearest + up - down) / DECIMALS_UNIT;
}

/** The scans of a run, in s. */
function scanTimes({step_size, stop_time}) {
  const scans = [];
  for (let i = 1, scan; (scan = rounded(i * step_size)) < stop_time; i++) scans.push(scan);
  return scans;
}

/** The communication points that are determined before the run. */
function communicationPoints(scenario, axis, scans, close) {
  const {step_size: h, stop_time: stop} = scenario;
  const named = [...scenario.settings.map((s) => s.at), ...scans, ...axis.points.slice(1), stop].filter((t) => t <= stop);
  const breaks = new Set(scenario.drive ? scans : axis.points), exact = new Set(named);
  const grid = Float64Array.from({length: Math.floor((stop / h) * (1 + 1e-12)) + 1}, (_, i) => i * h);
  const times = new Float64Array(grid.length + named.length), points = [];
  times.set(grid);
  times.set(named, grid.length);
  for (const t of times.sort()) {
    const last = points.at(-1);
    if (!points.length || t - last > close * h) points.push(t);
    else if (exact.has(t) && !breaks.has(last)) points[points.length - 1] = t;
  }
  return points;
}

// --- the scripted axis ---

/** Segments, one after the other, from time 0 on. After the last one the velocity stays as it is. */
class Script {
  constructor({position = 0, velocity = 0, acceleration = 0, segments = []}) {
    this.breaks = [0];
    this.motions = [];
    this.initial = [position, velocity, acceleration, 0];
    this.points = this.breaks;
    let ending = this.initial;
    for (const s of segments) {
      const first = s.jerk === undefined ? (s.acceleration ?? 0) : ending[2];
      this.motions.push([ending[0], s.velocity ?? ending[1], first, s.jerk ?? 0]);
      this.breaks.push(this.breaks.at(-1) + s.duration);
      ending = Script.after(this.motions.at(-1), s.duration);
    }
    this.motions.push([ending[0], ending[1], 0, 0]);
  }

  /** A recorded line, of which positions at times are known, and the velocities from each to the next. */
  static recorded({times, motions, velocity}) {
    const line = new Script({position: motions[0][0], velocity});
    line.breaks = times;
    line.motions = motions.map(([p, v]) => [p, v, 0, 0]);
    line.points = times.slice(0, 1);
    line.isRecorded = true;
    return line;
  }

  /** The motion a time before the start with which a delayed line starts. */
  startMotion(delay) {
    if (this.isRecorded) return this.initial;
    return delay > 0 ? Script.after(this.initial, -delay) : this.at(0);
  }

  /** Position, velocity, acceleration and jerk a time t later, with constant jerk. */
  static after([p, v, a, j], t) {
    return [p + t * (v + t * (a / 2 + (t * j) / 6)), v + t * (a + (t * j) / 2), a + t * j, j];
  }

  /** The motion at t; where it jumps at t, the motion after the jump. */
  at(t) {
    const i = Math.max(bisect(this.breaks, t, true) - 1, 0);
    return Script.after(this.motions[i], t - this.breaks[i]);
  }
}

/** When a line first runs evenly, and its velocity then; null: it never does. */
function rampEnd(axis) {
  const {motions, breaks} = new Script(axis), i = motions.findIndex(([, velocity, ...others]) => velocity && others.every((x) => x === 0));
  return i < 0 ? null : {at: breaks[i], velocity: motions[i][1]};
}

/** Let a line ramp up to another velocity than the original one does: with all its ramps in proportion, at the same times. */
function scaleTo(axis, original, velocity) {
  const scaled = (x) => (x * (velocity - (axis.velocity ?? 0))) / rampEnd(original).velocity;
  original.segments.forEach((segment, i) => {
    for (const name of ["velocity", "acceleration", "jerk"]) if (name in segment) axis.segments[i][name] = scaled(segment[name]);
  });
}

// --- telegrams ---

/** A receiver's clock and a sender's, and the telegrams that are seen of an axis; `normals`: by seed, the two streams. */
class Telegrams {
  constructor(remote, axis, starts, stopTime, normals, runner) {
    Object.assign(this, {remote, axis, runner});
    this.cycle = starts(remote.task_cycle);
    this.nominal = starts(remote.data_cycle) || this.cycle; // of the sender's cycles
    this.delay = starts(remote.delay);
    this.at = remote.rates.map((rate) => rate.at);
    this.lengths = remote.rates.map((rate) => rate.cycle);
    this.counts = [remote.phase]; // of the sender's cycles at these times
    for (let i = 1, sum = 0; i < this.at.length; i++) {
      sum += (this.at[i] - this.at[i - 1]) / this.lengths[i - 1];
      this.counts.push(remote.phase + sum);
    }
    this.cycles = this.acted(stopTime);
    this.received = this.#received(remote.jitter ? normals[remote.seed] : null);
  }

  /** How many cycles have acted before t. */
  acted(t) {
    return Math.max(Math.ceil(t / this.cycle - this.runner.cycle_close), 0);
  }

  /** The cycle whose telegram a step shows. */
  shown(begin, end) {
    return Math.max(Math.min(this.acted(begin), this.acted(end) - 1), 0);
  }

  /** The sender's index at a time: a real number that never wraps. */
  trueIndex(t) {
    const i = Math.max(bisect(this.at, t, true) - 1, 0);
    return this.remote.first_index + this.counts[i] + (t - this.at[i]) / this.lengths[i];
  }

  sent(index) {
    const counted = index - this.remote.first_index, i = Math.max(bisect(this.counts, counted, true) - 1, 0);
    return this.at[i] + (counted - this.counts[i]) * this.lengths[i];
  }

  #received(normals) {
    const {jitter, first_index: first, lost} = this.remote,
      {largest_jitter, sent_before_start: before} = this.runner,
      scale = jitter * this.cycle;
    const limit = largest_jitter * Math.min(this.cycle, ...this.lengths);
    const noise = (side, i) => (normals ? Math.min(Math.max(scale * normals[side][i], -limit), limit) : 0);
    const final = Math.trunc(this.trueIndex(this.cycles * this.cycle)) + before, index = [], sends = [];
    if (normals && (normals[0].length < this.cycles || normals[1].length < final - first + before)) {
      throw new Error(
        `the jitter of seed ${this.remote.seed} is available for ${normals[0].length} cycles, not ${this.cycles}`,
      );
    }
    for (let i = first - before; i < final; i++) {
      if (lost.some(([from, to]) => from <= i && i <= to)) continue;
      index.push(i);
      sends.push(this.sent(i) + noise(1, i - first + before));
    }
    return Array.from(
      {length: this.cycles},
      (_, i) => index[Math.max(bisect(sends, i * this.cycle + noise(0, i), true) - 1, 0)],
    );
  }

  /** Index, and motion, of the telegram of a cycle. */
  telegram(cycle) {
    const index = this.received[cycle];
    return [modulo(index, this.remote.wraps_at), this.axis.at(this.sent(index))];
  }
}

// --- the tables in the module's memory ---

/** The module's memory behind what it needs itself: tables are written there one after the other. */
class TableMemory {
  constructor(memory, layouts) {
    Object.assign(this, {memory, layouts, first: memory.buffer.byteLength});
    this.clear();
  }

  clear() {
    this.next = this.first;
  }

  /** The address of so many numbers of 8 bytes. */
  reserve(count) {
    const address = this.next;
    this.next += 8 * count;
    const missing = this.next - this.memory.buffer.byteLength;
    if (missing > 0) this.memory.grow(Math.ceil(missing / PAGE));
    return address;
  }

  reals(address, count) {
    return new Float64Array(this.memory.buffer, address, count);
  }

  writeReals(values) {
    const address = this.reserve(values.length);
    this.reals(address, values.length).set(values);
    return address;
  }

  writeIntegers(values) {
    const address = this.reserve(values.length);
    new BigInt64Array(this.memory.buffer, address, values.length).set(values.map(BigInt));
    return address;
  }

  /** Rows of a structure, by its name in C; a member that a row does not have is 0. */
  writeRows(name, rows) {
    const members = Object.entries(this.layouts[name]),
      address = this.reserve(members.length * rows.length),
      view = new DataView(this.memory.buffer, address);
    rows.forEach((row, i) =>
      members.forEach(([member, real], k) => {
        const at = 8 * (i * members.length + k);
        if (real) view.setFloat64(at, row[member] ?? 0, true);
        else view.setBigInt64(at, BigInt(row[member] ?? 0), true);
      }),
    );
    return address;
  }

  /** A member of a structure that has one row. */
  integer(name, address, member) {
    const at = address + 8 * Object.keys(this.layouts[name]).indexOf(member);
    return Number(new DataView(this.memory.buffer).getBigInt64(at, true));
  }

  /** The motion of a run's axis at its k-th point. */
  motion(run, k) {
    return this.reals(this.integer("Run", run, "axis") + 32 * k, 4);
  }

  real(name, address, member) {
    return this.reals(address + 8 * Object.keys(this.layouts[name]).indexOf(member), 1)[0];
  }
}

/** Settings and reactions as tables: what is assigned when. */
function assignmentTables(unit, scenario, scans) {
  const {memory, runner} = unit;
  const timed = [...scenario.settings].sort((a, b) => a.at - b.at);
  const assignments = [], bundles = [];
  for (const {values, set, add} of [...timed, ...scenario.reactions]) {
    const first = assignments.length;
    for (const [adds, given] of [values ?? set, add ?? {}].entries()) {
      for (const [name, x] of Object.entries(given)) {
        const {offset, kind} = unit.declared(name);
        assignments.push({offset, kind: runner.kinds[kind], adds, [kind === "Real" ? "real" : "word"]: kind === "Real" ? x : Math.trunc(x)});
      }
    }
    bundles.push({first, last: assignments.length});
  }
  const most = (scans.length + 1) >> 1; // so often something becomes true
  const capacity = scenario.reactions.reduce((sum, r) => sum + Math.min(r.times ?? most, most), timed.length);
  const events = memory.writeRows("Event", timed.map(({at}, what) => ({at, what})));
  memory.reserve(2 * (capacity - timed.length)); // for those of reactions
  const reactions = scenario.reactions.map((r, i) => {
    const {offset, kind} = unit.declared(r.name);
    return {
      offset,
      kind: runner.kinds[kind],
      comparison: runner.comparisons[r.comparison],
      value: r.value,
      margin: runner.margin * Math.max(1, Math.abs(r.value)),
      at: memory.writeReals(r.after ? scans.map((scan) => rounded(scan + r.after)) : scans),
      times: r.times ?? -1,
      what: timed.length + i,
    };
  });
  return {
    events,
    event_count: timed.length,
    capacity,
    bundles: memory.writeRows("Bundle", bundles),
    assignments: memory.writeRows("Assignment", assignments),
    reactions: memory.writeRows("Reaction", reactions),
    reaction_count: reactions.length,
    assigned: new Set(assignments.map(({offset}) => offset)),
  };
}

/** What the runner needs of the axis: a script, telegrams, or the beginning of a master that follows the block. */
function axisTables(unit, scenario, {axis, telegrams, scans}) {
  const {memory, runner} = unit, {drive, step_size: h} = scenario;
  if (telegrams) {
    const seen = Array.from({length: telegrams.cycles}, (_, cycle) => telegrams.telegram(cycle));
    return {
      indices: memory.writeIntegers(seen.map(([index]) => index)),
      telegrams: memory.writeReals(seen.flatMap(([, motion]) => motion.slice(0, 3))),
      cycle: telegrams.cycle,
      ...scriptTables(memory, axis),
      follows: -1,
    };
  }
  if (!drive) return {...scriptTables(memory, axis), follows: -1};
  const {offset, kind} = unit.declared(drive.follows);
  const tables = scriptTables(memory, axis, scans.length);
  return {
    ...tables,
    motion_count: 1,
    motion_capacity: scans.length + 1,
    follows: offset,
    kind: runner.kinds[kind],
    gain: drive.scan === h ? drive.gain : -Math.expm1(-h / drive.time_constant),
    most: drive.max_acceleration ?? Infinity,
    scan: h,
  };
}

/** The scenario with the start values of a block with these variables that takes what its encoder measures, unless it has others. */
function withMeasuredInputs(scenario, variables) {
  const {encoder, start} = scenario, values = {[INPUT_MODE]: MEASURED};
  if (!encoder) return scenario;
  if (variables.some(({name}) => name === SCALING)) values[SCALING] = encoder.resolution;
  if ((start[INPUT_MODE] ?? MEASURED) === MEASURED) {
    for (const [name, key] of Object.entries(OF_ENCODER)) values[name] = encoder[key];
  }
  return {...scenario, start: {...values, ...start}};
}

/** The address of the encoder between the line and the block; 0: there is none. */
function encoderTable({memory}, {encoder: e, step_size: h}, axis) {
  if (!e) return 0;
  const [initial_position, initial_velocity, initial_acceleration] = axis.initial;
  const [, velocity, acceleration] = axis.startMotion(e.delay);
  const row = {
    ...e,
    amplitude: e.runout_amplitude,
    length: e.runout_length,
    interval: e.sample_time || h,
    initial_position,
    initial_velocity,
    initial_acceleration,
    start_velocity: velocity * e.scale,
    start_acceleration: acceleration * e.scale,
    number: -1,
  };
  return memory.writeRows("Encoder", [row]);
}

/** `more`: so many motions can follow. */
function scriptTables(memory, {breaks, motions}, more = 0) {
  const tables = {breaks: memory.writeReals(breaks)};
  memory.reserve(more);
  tables.motions = memory.writeReals(motions.flat());
  memory.reserve(4 * more);
  return {...tables, motion_count: motions.length};
}

/** All tables of a run: the addresses of the structures Scenarios and Run, and how many points can be recorded. */
function writeTables(unit, scenario, {axis, telegrams}) {
  const {memory, runner, variables} = unit, {step_size: h, stop_time, remote, start} = scenario;
  memory.clear();
  const scans = scenario.reactions.length || scenario.drive ? scanTimes(scenario) : [];
  const points = communicationPoints(scenario, axis, scans, runner.close);
  const {capacity: events, assigned, ...given} = assignmentTables(unit, scenario, scans);
  const part = remote?.part ?? "master",
    inputs = Object.fromEntries(MOTION.map((name) => [name, unit.declared(`${part}.${name}`).offset]));
  const checked = variables.filter((v) => v.limit !== undefined && [...assigned, ...Object.values(inputs)].includes(v.offset));
  const limits = checked.map(({offset, limit}) => {
    const [least, greatest, smallest, zero] = runner.limits[limit];
    return {offset, least, greatest, smallest, zero};
  });
  const run = {
    block: unit.block,
    close: runner.close * h,
    stop_time,
    period: start["master.period"] ?? 0,
    end_of_step: start[INPUT_MODE] === END_OF_STEP ? 1 : 0,
    points: memory.writeReals(points),
    point_count: points.length,
    scans: memory.writeReals(scans),
    scan_count: scans.length,
    before: runner.sample_lead * h,
    ...given,
    ...axisTables(unit, scenario, {axis, telegrams, scans}),
    encoder: encoderTable(unit, scenario, axis),
  };
  const capacity = points.length + scans.length + events;
  run.times = memory.reserve((5 + variables.length) * capacity);
  run.axis = run.times + 8 * capacity;
  run.values = run.axis + 32 * capacity;
  run.column = 8 * capacity;
  const sinks = variables.map(({offset, kind}) => ({offset, kind: runner.kinds[kind]}));
  const common = {
    ...inputs,
    cycle_index: remote ? unit.declared(remote.cycle_index).offset : 0,
    limits: memory.writeRows("Limited", limits),
    limit_count: limits.length,
    sinks: memory.writeRows("Field", sinks),
    sink_count: sinks.length,
    closest: runner.cycle_close,
  };
  return {scenarios: memory.writeRows("Scenarios", [common]), run: memory.writeRows("Run", [run]), capacity};
}
