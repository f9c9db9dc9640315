"use strict";
// A run of a scenario, as the compiled package `runner` carries it: its numbers are written into the module's memory, as
// scenario/run/tables.py has them. The script and the telegrams follow script.py and clocks.py, sum by sum. Numbers that have
// one meaning in all languages come with the page, as `runner`.

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

// --- a run in the module's memory ---

/** A run, behind what the module itself needs in its memory; its numbers from outside are behind it. */
class RunMemory {
  /** `layout`: offset, kind and start value of each member, by its name; `size`: that of all. */
  constructor(memory, {layout, size}) {
    Object.assign(this, {memory, layout, size, address: memory.buffer.byteLength, sets: []});
  }

  /** Start anew. */
  clear() {
    this.end = this.address;
    this.sets = [];
    this.reserve(Math.ceil(this.size / 8));
    for (const [name, [, kind, start]] of Object.entries(this.layout)) this.#write(name, start, kind === "reals" || kind === "wholes" ? 0 : undefined);
  }

  /** The address of so many numbers of 8 bytes. */
  reserve(count) {
    const address = this.end;
    this.end += 8 * count;
    const missing = this.end - this.memory.buffer.byteLength;
    if (missing > 0) this.memory.grow(Math.ceil(missing / PAGE));
    return address;
  }

  /** Set members, by their names; a list of numbers is written behind all others. */
  set(members) {
    for (const [name, value] of Object.entries(members)) {
      if (value.length === undefined) {
        this.#write(name, value);
        continue;
      }
      const isReal = this.layout[name][1] === "reals", Numbers = isReal ? Float64Array : BigInt64Array;
      const address = this.reserve(value.length), numbers = new Numbers(this.memory.buffer, address, value.length);
      numbers.set(isReal ? value : Array.from(value, BigInt));
      this.#write(name, address, value.length);
    }
  }

  /** Let a member have space for so many numbers. */
  give(name, count) {
    this.#write(name, this.reserve(count), count);
  }

  #write(name, value, count) {
    const [offset, kind] = this.layout[name], view = new DataView(this.memory.buffer, this.address + offset);
    if (kind === "real") view.setFloat64(0, value, true);
    else if (kind === "flag") view.setUint8(0, value);
    else view.setBigInt64(0, BigInt(value), true);
    if (count !== undefined) view.setBigInt64(8, BigInt(count), true);
  }

  /** A member; of a list its address. */
  get(name) {
    const [offset, kind] = this.layout[name], view = new DataView(this.memory.buffer, this.address + offset);
    return kind === "real" ? view.getFloat64(0, true) : Number(view.getBigInt64(0, true));
  }

  reals(address, count) {
    return new Float64Array(this.memory.buffer, address, count);
  }

  /** Note that a variable has been set, if the run sets it, too: what it adds is added to the present value. */
  note(name, value) {
    const k = this.sets.indexOf(name);
    if (k >= 0) this.reals(this.get("program.values") + 8 * k, 1)[0] = value;
  }

  /** The motion of the axis at the k-th point. */
  motion(k) {
    return this.reals(this.get("host.axis") + 32 * k, 4);
  }
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

/** So many numbers that are 0. */
const zeros = (count) => new Float64Array(count);

/** What is set when, and what reacts to what; the variables that are set, and the outputs that are seen, have numbers. */
function programOf(unit, scenario, scans) {
  const {runner} = unit, {reactions, drive} = scenario;
  const timed = [...scenario.settings].sort((a, b) => a.at - b.at);
  const bundles = [...timed.map(({values}) => [values, {}]), ...reactions.map(({set, add}) => [set, add])];
  const sets = [...new Set(bundles.flatMap((parts) => parts.flatMap(Object.keys)))];
  const sees = [...new Set([...reactions.map(({name}) => name), ...(drive ? [drive.follows] : [])])];
  const rows = bundles.map((parts) => parts.flatMap((part, adds) => Object.entries(part).map(([name, x]) => [sets.indexOf(name), x, adds])));
  const first = [0];
  for (const row of rows) first.push(first.at(-1) + row.length);
  const most = (scans + 1) >> 1; // so often something becomes true
  const capacity = reactions.reduce((sum, {times}) => sum + Math.min(times ?? most, most), 0);
  const places = (names) => names.flatMap((name) => [unit.declared(name).offset, runner.stored[unit.declared(name).kind]]);
  const of = (part, key) => ({[`program.reactions.${key}`]: reactions.map(part)});
  return {
    sets,
    "program.at": [...timed.map(({at}) => at), ...zeros(capacity)],
    "program.what": [...timed.keys(), ...zeros(capacity)],
    "program.count": timed.length,
    "program.settings": timed.length,
    "program.first": first,
    "program.target": rows.flat().map(([target]) => target),
    "program.amount": rows.flat().map(([, amount]) => amount),
    "program.adds": rows.flat().map(([, , adds]) => adds),
    "program.values": sets.map((name) => unit.get(name)),
    "program.outputs": zeros(sees.length),
    ...of(({name}) => sees.indexOf(name), "output"),
    ...of(({comparison}) => runner.comparisons[comparison], "comparison"),
    ...of(({value}) => value, "value"),
    ...of(({after}) => after, "after"),
    ...of(({times}) => times ?? -1, "most"),
    ...of(() => 0, "held"),
    ...of(() => 0, "happened"),
    ...(drive && {
      "program.follows": sees.indexOf(drive.follows),
      "program.gain": drive.scan === scenario.step_size ? drive.gain : -Math.expm1(-scenario.step_size / drive.time_constant),
      "program.max_acceleration": drive.max_acceleration ?? Infinity,
    }),
    "host.sets": places(sets),
    "host.sees": places(sees),
  };
}

/** The axis with space for so many motions more, and what is between it and the block. */
function axisOf({breaks, motions, initial, isRecorded}, more, {encoder: e, step_size: h}, telegrams) {
  const seen = telegrams && Array.from({length: telegrams.cycles}, (_, cycle) => telegrams.telegram(cycle));
  return {
    "axis.breaks": [...breaks, ...zeros(more)],
    "axis.motions": [...motions.flat(), ...zeros(4 * more)],
    "axis.count": breaks.length,
    "axis.is_recorded": isRecorded ? 1 : 0,
    ...Object.fromEntries(MOTION.map((name, i) => [`axis.start_${name}`, initial[i]])),
    ...(e && {has_encoder: 1, "encoder.interval": e.sample_time || h}),
    ...(e && Object.fromEntries(Object.entries(e).map(([name, x]) => [`encoder.${name}`, x]))),
    ...(seen && {
      is_remote: 1,
      "telegrams.cycle": telegrams.cycle,
      "telegrams.cycle_index": seen.map(([index]) => index),
      "telegrams.motion": seen.flatMap(([, motion]) => motion.slice(0, 3)),
    }),
  };
}

/** Write a run into memory. How many points can be recorded: each is one of the times that are known, or a reaction's. */
function writeRun(unit, scenario, {axis, telegrams}) {
  const {run, runner, variables} = unit, {step_size: h, stop_time: stop, remote, start, drive} = scenario;
  const scans = scenario.reactions.length || drive ? Math.trunc(stop / h) + 1 : 0;
  const named = Float64Array.from([...scenario.settings.map(({at}) => at), stop].filter((t) => t <= stop)).sort();
  const {sets, ...program} = programOf(unit, scenario, scans);
  const inputs = MOTION.map((name) => [name, unit.declared(`${remote?.part ?? "master"}.${name}`).offset]);
  const given = new Set([...inputs.map(([, offset]) => offset), ...program["host.sets"].filter((_, i) => i % 2 === 0)]);
  const checked = variables.filter(({offset, limit}) => limit !== undefined && given.has(offset));
  run.clear();
  run.set({
    ...program,
    ...axisOf(axis, drive ? scans : 0, scenario, telegrams),
    "points.step_size": h,
    "points.stop_time": stop,
    "points.scan": scans ? h : 0,
    "points.named": named,
    "points.has_drive": drive ? 1 : 0,
    period: start["master.period"] ?? 0,
    is_ahead: start[INPUT_MODE] === END_OF_STEP ? 1 : 0,
    "host.block": unit.block,
    ...Object.fromEntries(inputs.map(([name, offset]) => [`host.${name}`, offset])),
    "host.cycle_index": remote ? unit.declared(remote.cycle_index).offset : 0,
    "host.records": variables.flatMap(({offset, kind}) => [offset, runner.stored[kind]]),
    "host.checks": checked.map(({offset}) => offset),
    "host.limits": checked.flatMap(({limit}) => runner.limits[limit]),
  });
  run.sets = sets;
  const capacity = Math.trunc((stop / h) * (1 + 1e-12)) + 1 + named.length + axis.points.length + 2 * scans + program["program.at"].length;
  run.give("host.times", capacity);
  run.give("host.axis", 4 * capacity);
  run.give("host.values", variables.length * capacity);
  return capacity;
}
