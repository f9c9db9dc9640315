"use strict";
// A block in WebAssembly, and its runs along scenarios, which the module carries itself: the runner is that of batches. It
// knows nothing of the page.

const MOST_STEPS = 200000; // of one run: a page has to stay quick

// --- the block ---

/** One unit. It is set and read by the names of its variables; `lines` collects what it logs, as time, status and text. */
class Unit {
  /** `variables`: those of the block in the order of their value references; `runner`: see tables.js. */
  constructor(variables, runner) {
    Object.assign(this, {variables, runner, lines: [], block: 0, now: () => 0});
    this.columns = new Map(variables.map((v, i) => [v.name, i]));
  }

  /** Instantiate compiled code: `bytes` of the module, or the module. */
  static async of(bytes, variables, runner) {
    const unit = new Unit(variables, runner);
    const log = (status, address, length) => {
      const text = new TextDecoder().decode(new Uint8Array(unit.code.memory.buffer, address, length));
      unit.lines.push({t: unit.now(), status, text});
    };
    const {instance} = await WebAssembly.instantiate(bytes, {page: {log}});
    unit.code = instance.exports;
    unit.reset();
    unit.run = new RunMemory(unit.code.memory, runner);
    return unit;
  }

  reset() {
    this.lines = [];
    this.now = () => 0;
    this.block = this.code.reset();
    if (!this.block) throw new Error("the block does not fit into memory");
  }

  declared(name) {
    const variable = this.variables[this.columns.get(name)];
    if (!variable) throw new Error(`there is no variable ${name}`);
    return variable;
  }

  set(values) {
    for (const name in values) this.#write(name, values[name]);
  }

  #write(name, value) {
    const {kind} = this.declared(name), {code} = this;
    const write = kind === "Real" ? code.set_real : kind === "Boolean" ? code.set_boolean : code.set_integer;
    this.run?.note(name, Number(value));
    if (write(this.columns.get(name), value)) throw new Error(this.lines.pop()?.text ?? `${name} cannot be set`);
  }

  get(name) {
    const {kind, offset} = this.declared(name), view = new DataView(this.code.memory.buffer, this.block + offset);
    return kind === "Real" ? view.getFloat64(0, true) : kind === "Boolean" ? view.getUint8(0) : view.getInt32(0, true);
  }
}

// --- a run ---

/** The recorded points of a run: the block's variables, and the motion of the scripted axis, without wrapping. */
class Course {
  /** `storage`: that of a run that is no longer needed; to fill new memory takes longer than the run itself. */
  constructor({run, columns}, capacity, storage) {
    const first = run.get("host.times");
    this.count = run.get("host.count");
    this.columns = columns;
    const size = (5 + columns.size) * this.count;
    this.storage = this.count > 1 && storage?.length >= size ? storage : new Float64Array(size); // else that run is still shown
    const copy = (column, source, width = 1) =>
      this.storage.set(run.reals(first + 8 * source, width * this.count), column * this.count);
    copy(0, 0);
    copy(1, capacity, 4);
    for (let k = 5; k < 5 + columns.size; k++) copy(k, k * capacity);
    this.time = this.#column(0);
    this.axes = [];
  }

  #column(k) {
    return this.storage.subarray(k * this.count, (k + 1) * this.count);
  }

  /** A variable at all points. */
  column(name) {
    return this.#column(5 + this.columns.get(name));
  }

  value(name, k) {
    return this.column(name)[k];
  }

  /** Position (0), velocity (1) or acceleration (2) of the scripted axis at all points. */
  axis(order) {
    return (this.axes[order] ??= this.time.map((_, k) => this.storage[this.count + 4 * k + order]));
  }

  /** Of a remote axis: how far telegrams and slave are from the truth. */
  get errors() {
    return (this.errorsOnce ??= errorsOf(this));
  }
}

/**
 * A whole run of a scenario. `cycle(t, unit, motion)`: a program that may set the block before each step but the first,
 * since what is set at 0 is a start value; `normals`, `storage`: see Telegrams and Course. The course ends before a refused
 * step; then `refused` is true, and the last line has the reason.
 */
function run(unit, described, {cycle = null, normals = {}, storage = null} = {}) {
  const scenario = withMeasuredInputs(described, unit.variables), {step_size: h, stop_time: stop} = scenario;
  if (!(stop / h <= MOST_STEPS)) {
    throw new Error(`step_size = ${h} is not allowed: it must be >= ${stop / MOST_STEPS}, for at most ${MOST_STEPS} steps up to ${stop} s`);
  }
  const begin = performance.now();
  const {position, velocity} = scenario.axis;
  const isRecorded = "times" in scenario.axis;
  const axis = isRecorded ? Script.recorded(scenario.axis) : new Script(scenario.drive ? {position, velocity} : scenario.axis);
  const starts = (name) => scenario.start[name] ?? unit.declared(name).start;
  const telegrams = scenario.remote && new Telegrams(scenario.remote, axis, starts, stop, normals, unit.runner);
  unit.reset();
  unit.set(scenario.start);
  const capacity = writeRun(unit, scenario, {axis, telegrams}), {address} = unit.run;
  unit.now = () => unit.run.get("now");
  const given = [];
  let refused = unit.code.initialize(address) !== 0;
  const inputs = () => MOTION.map((name) => unit.get(`master.${name}`)); // with an encoder nobody knows more of the line
  const motion = (t, k) => (scenario.encoder ? inputs() : scenario.drive ? unit.run.motion(k) : axis.at(t));
  if (!refused) refused = (cycle ? driven(unit, {cycle, motion, given}) : unit.code.carry(address)) !== 0;
  unit.code.terminate();
  const course = new Course(unit, capacity, storage);
  return Object.assign(course, {
    ...{scenario, script: axis, telegrams, refused, given},
    lines: unit.lines,
    spent: performance.now() - begin,
  });
}

/** The steps one by one, with a program before each but the first; `given` takes what it sets that is not there yet. */
function driven(unit, {cycle, motion, given}) {
  const {code} = unit, {address} = unit.run;
  let status = 0;
  for (let k = 0; !status && code.prepare(address); k++) {
    if (k) {
      const t = unit.now(), values = watched(unit, () => cycle(t, unit, motion(t, k)));
      if (Object.keys(values).length) given.push({at: t, values});
    }
    status = code.step(address);
  }
  return status;
}

/** What an act sets that is not there yet. */
function watched(unit, act) {
  const set = unit.set.bind(unit), values = {};
  unit.set = (some) => {
    for (const [name, value] of Object.entries(some)) {
      if (unit.get(name) !== Number(value)) values[name] = Number(value);
    }
    set(some);
  };
  try {
    act();
  } finally {
    delete unit.set;
  }
  return values;
}

/** SHA-256 of these variables at all points of a run, point by point. */
async function fingerprint(course, names) {
  const columns = names.map((name) => course.column(name)), rows = new Float64Array(course.count * names.length);
  for (let k = 0, at = 0; k < course.count; k++) {
    for (const column of columns) rows[at++] = column[k];
  }
  const digest = await crypto.subtle.digest("SHA-256", rows);
  return Array.from(new Uint8Array(digest), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
