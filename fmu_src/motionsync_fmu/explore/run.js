"use strict";
// A block in WebAssembly, and its runs along scenarios. It knows nothing of the page. All that the block is given has the
// same bits as in Python: what stands here follows scenario/script.py, clocks.py, reactions.py and run.py, sum by sum.

const CLOSE = 1e-9; // of a step: communication points nearer to one another are one
const LOOK = 1 / 128; // of a scan: how long before it the outputs are looked at
const MARGIN = 1e-9; // of a value, at least of 1: by so much it is beyond another, or else it is equal
const DECIMALS = 12; // of a scan's time in s
const START_OF_STEP = 1,
  END_OF_STEP = 2; // master.input_mode
const CYCLE_CLOSE = 1e-6; // of a cycle: a time that follows an instant by less is taken for that instant
const FARTHEST = 0.45; // of the shorter cycle: jitter moves no instant farther
const BEFORE = 2; // telegrams sent before time 0
const MOST_STEPS = 200000; // of one run: a page has to stay quick
const PAGE = 65536; // bytes that memory grows by

// --- the block ---

/** One unit. It is set and asked by the names of its variables; `lines` collects what it logs, as status and text. */
class Unit {
  /** `code`: the exports of the module, `variables`: the block's variables in the order of their value references. */
  constructor(code, variables) {
    this.code = code;
    this.lines = [];
    this.kinds = new Map(variables.map((v, i) => [v.name, {...v, reference: i}]));
    const of = (...kinds) => variables.filter((v) => kinds.includes(v.kind)).map((v) => v.name);
    const groups = [of("Real"), of("Integer", "Enumeration"), of("Boolean")];
    this.counts = groups.map((group) => group.length);
    this.names = groups.flat(); // in the order of a row
    this.places = new Map(this.names.map((name, i) => [name, i]));
    this.base = PAGE * code.memory.grow(Math.ceil((16 + 16 * variables.length) / PAGE));
    this.list = this.base + 16; // behind one value and one reference: all references, then a row
    this.row = this.list + 8 * Math.ceil(variables.length / 2);
    this.#look();
    this.integers.set(
      this.names.map((name) => this.kinds.get(name).reference),
      this.list / 4,
    );
  }

  /** Instantiate compiled code: `bytes` of the module, or the module. */
  static async of(bytes, variables) {
    const lines = [];
    let memory = null;
    const told = (status, place, length) => {
      lines.push({status, text: new TextDecoder().decode(new Uint8Array(memory.buffer, place, length))});
    };
    const {instance} = await WebAssembly.instantiate(bytes, {page: {told}});
    memory = instance.exports.memory;
    const unit = new Unit(instance.exports, variables);
    unit.lines = lines;
    return unit;
  }

  /** Memory as integers and as Reals, as it is now: memory that has grown has another buffer. */
  #look() {
    const {buffer} = this.code.memory;
    if (this.reals?.buffer !== buffer) {
      this.integers = new Int32Array(buffer);
      this.reals = new Float64Array(buffer);
    }
  }

  begin() {
    this.lines.length = 0;
    if (!this.code.begin()) throw new Error("the block does not fit into memory");
  }

  /** 0, or that the block refuses its start values; it logs why. */
  initialize() {
    return this.code.initialize();
  }

  /** 0, or that the block refuses the step; it logs why. */
  step(h) {
    return this.code.step(h);
  }

  set(values) {
    for (const name in values) this.#put(name, values[name]);
  }

  #put(name, value) {
    const {kind, reference} = this.#known(name),
      {base, code} = this;
    this.#look();
    this.integers[base / 4 + 2] = reference;
    if (kind === "Real") this.reals[base / 8] = value;
    else this.integers[base / 4] = value;
    const setter = kind === "Real" ? code.set_reals : kind === "Boolean" ? code.set_booleans : code.set_integers;
    if (setter(base + 8, 1, base)) throw new Error(this.lines.pop()?.text ?? `${name} cannot be set`);
  }

  #known(name) {
    const known = this.kinds.get(name);
    if (!known) throw new Error(`there is no variable ${name}`);
    return known;
  }

  get(name) {
    const {kind, reference} = this.#known(name),
      {base} = this,
      real = kind === "Real" ? 1 : 0,
      boolean = kind === "Boolean" ? 1 : 0;
    this.#look();
    this.integers[base / 4 + 2] = reference;
    this.code.get(base + 8, real, 1 - real - boolean, boolean, base);
    return this.reals[base / 8];
  }

  /** All variables as numbers, in the order of `names`: a view, good until the next call. */
  values() {
    this.code.get(this.list, this.counts[0], this.counts[1], this.counts[2], this.row);
    this.#look();
    return this.reals.subarray(this.row / 8, this.row / 8 + this.names.length);
  }
}

// --- the scripted axis ---

/** How many of the sorted `times` are not after t (`right`), or before t. */
function bisect(times, t, right) {
  let low = 0,
    high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (right ? times[middle] <= t : times[middle] < t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Position, velocity, acceleration and jerk a time t later, with constant jerk. */
function after([p, v, a, j], t) {
  return [p + t * (v + t * (a / 2 + (t * j) / 6)), v + t * (a + (t * j) / 2), a + t * j, j];
}

/** Segments, one after the other, from time 0 on. After the last one the velocity stays as it is. */
class Script {
  constructor({position = 0, velocity = 0, acceleration = 0, segments = []}) {
    this.breaks = [0];
    this.motions = [];
    let ending = [position, velocity, acceleration, 0];
    for (const s of segments) {
      const begun = s.jerk === undefined ? (s.acceleration ?? 0) : ending[2];
      const begin = [ending[0], s.velocity ?? ending[1], begun, s.jerk ?? 0];
      this.motions.push(begin);
      this.breaks.push(this.breaks.at(-1) + s.duration);
      ending = after(begin, s.duration);
    }
    this.motions.push([ending[0], ending[1], 0, 0]);
  }

  goOn(t, acceleration) {
    const [p, v] = this.until(t);
    this.breaks.push(t);
    this.motions.push([p, v, acceleration, 0]);
  }

  /** The motion at t; where it jumps at t, the motion after the jump. */
  at(t) {
    const i = Math.max(bisect(this.breaks, t, true) - 1, 0);
    return after(this.motions[i], t - this.breaks[i]);
  }

  /** The motion at t; where it jumps at t, the motion before the jump. */
  until(t) {
    const i = Math.max(bisect(this.breaks, t, false) - 1, 0);
    return after(this.motions[i], t - this.breaks[i]);
  }
}

/** The remainder with the sign of the divisor, as Python has it. */
function modulo(x, y) {
  const rest = x % y;
  return rest !== 0 && rest < 0 !== y < 0 ? rest + y : rest;
}

/** A time with DECIMALS decimals: the nearest one, and of two the even one. */
function rounded(t) {
  const halves = t * 8192; // a tie has 13 decimals, so it is an odd multiple of 2**-13
  if (Number.isSafeInteger(halves) && halves % 2 !== 0) {
    const down = (BigInt(halves) * 5n ** 13n - 5n) / 10n;
    return Number(`${down % 2n === 0n ? down : down + 1n}e-${DECIMALS}`);
  }
  return Number(t.toFixed(DECIMALS));
}

// --- telegrams ---

/** A receiver's clock and a sender's, and the telegrams that are seen of an axis; `normals`: by seed, the two streams. */
class Telegrams {
  constructor(remote, axis, starts, stopTime, normals) {
    Object.assign(this, {remote, axis});
    this.cycle = starts(remote.task_cycle);
    this.nominal = starts(remote.data_cycle) || this.cycle; // of the sender's cycles
    this.delay = starts(remote.delay);
    this.at = remote.rates.map((rate) => rate.at);
    this.lengths = remote.rates.map((rate) => rate.cycle);
    this.begun = [remote.phase];
    for (let i = 1, sum = 0; i < this.at.length; i++) {
      sum += (this.at[i] - this.at[i - 1]) / this.lengths[i - 1];
      this.begun.push(remote.phase + sum);
    }
    this.cycles = this.acted(stopTime);
    this.received = this.#received(remote.jitter ? normals[remote.seed] : null);
  }

  acted(t) {
    return Math.max(Math.ceil(t / this.cycle - CYCLE_CLOSE), 0);
  }

  /** The cycle whose telegram a step shows. */
  shown(begin, end) {
    return Math.max(Math.min(this.acted(begin), this.acted(end) - 1), 0);
  }

  /** The sender's index at a time: a real number that never wraps. */
  trueIndex(t) {
    const i = Math.max(bisect(this.at, t, true) - 1, 0);
    return this.remote.first_index + this.begun[i] + (t - this.at[i]) / this.lengths[i];
  }

  sent(index) {
    const counted = index - this.remote.first_index,
      i = Math.max(bisect(this.begun, counted, true) - 1, 0);
    return this.at[i] + (counted - this.begun[i]) * this.lengths[i];
  }

  #received(normals) {
    const {jitter, first_index: first, lost} = this.remote,
      scale = jitter * this.cycle;
    const limit = FARTHEST * Math.min(this.cycle, ...this.lengths);
    const noise = (side, i) => (normals ? Math.min(Math.max(scale * normals[side][i], -limit), limit) : 0);
    const final = Math.trunc(this.trueIndex(this.cycles * this.cycle)) + BEFORE,
      index = [],
      sends = [];
    if (normals && (normals[0].length < this.cycles || normals[1].length < final - first + BEFORE)) {
      throw new Error(
        `the jitter of seed ${this.remote.seed} is known for ${normals[0].length} cycles, not ${this.cycles}`,
      );
    }
    for (let i = first - BEFORE; i < final; i++) {
      if (lost.some(([from, to]) => from <= i && i <= to)) continue;
      index.push(i);
      sends.push(this.sent(i) + noise(1, i - first + BEFORE));
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

  inputs(begin, end) {
    const [index, motion] = this.telegram(this.shown(begin, end)),
      part = this.remote.part;
    return {
      [this.remote.cycle_index]: index,
      [`${part}.position`]: motion[0],
      [`${part}.velocity`]: motion[1],
      [`${part}.acceleration`]: motion[2],
    };
  }
}

// --- reactions ---

/** The scans of a run, in s. */
function scansOf(scenario) {
  const found = [];
  for (let i = 1, scan; (scan = rounded(i * scenario.step_size)) < scenario.stop_time; i++) found.push(scan);
  return found;
}

function holds({comparison, value}, output) {
  const beyond = output - value,
    margin = MARGIN * Math.max(1, Math.abs(value));
  return comparison === "<" ? beyond < -margin : comparison === ">" ? beyond > margin : Math.abs(beyond) <= margin;
}

/** Everything that a scenario gives the block in one run: its settings, its reactions, and the motion of its master. */
class Program {
  constructor(scenario, axis, starts) {
    Object.assign(this, {scenario, axis});
    this.reacts = scenario.reactions.length > 0 || scenario.drive !== null;
    this.scans = this.reacts ? scansOf(scenario) : [];
    this.next = 0;
    this.held = [];
    this.happened = scenario.reactions.map(() => 0);
    const added = scenario.reactions.flatMap((r) => Object.keys(r.add));
    this.present = Object.fromEntries(added.map((name) => [name, starts(name)]));
    this.waiting = [];
    this.set = []; // all that has been set, in this order
    for (const s of scenario.settings) this.#wait(s.at, s.values, {});
  }

  get nextLook() {
    const scan = this.scans[this.next];
    return scan === undefined ? Infinity : scan - LOOK * this.scenario.step_size;
  }

  get nextSetting() {
    return this.waiting.length ? this.waiting[0].at : Infinity;
  }

  begin(unit) {
    this.held = this.scenario.reactions.map((r) => holds(r, unit.get(r.name)));
  }

  look(unit) {
    const scan = this.scans[this.next++],
      {drive, step_size, stop_time, reactions} = this.scenario;
    if (drive) {
      const velocity = this.axis.until(scan)[1],
        gain = drive.scan === step_size ? drive.gain : -Math.expm1(-step_size / drive.time_constant),
        needed = ((unit.get(drive.follows) - velocity) * gain) / step_size;
      const most = drive.max_acceleration ?? Infinity;
      this.axis.goOn(scan, Math.min(Math.max(needed, -most), most));
    }
    reactions.forEach((r, i) => {
      const held = this.held[i],
        at = rounded(scan + r.after);
      this.held[i] = holds(r, unit.get(r.name));
      if (this.held[i] && !held && this.happened[i] !== r.times && at < stop_time) {
        this.happened[i]++;
        this.#wait(at, r.set, r.add);
      }
    });
  }

  /** The values that are set up to a time, in s; they count as set from now on. */
  take(until) {
    const values = {};
    while (this.nextSetting <= until) {
      const due = this.waiting.shift(),
        given = {...due.set};
      for (const [name, more] of Object.entries(due.add)) given[name] = this.present[name] + more;
      for (const name of Object.keys(given)) if (name in this.present) this.present[name] = given[name];
      this.set.push({at: due.at, values: given});
      Object.assign(values, given);
    }
    return values;
  }

  #wait(at, set, add) {
    const place = this.waiting.findIndex((other) => other.at > at);
    this.waiting.splice(place < 0 ? this.waiting.length : place, 0, {at, set, add});
  }
}

// --- a run ---

/** The communication points that are known before the run. */
function points(scenario, axis, scans) {
  const h = scenario.step_size,
    stop = scenario.stop_time;
  const extra = [...scenario.settings.map((s) => s.at), ...scans, ...axis.breaks.slice(1), stop];
  const breaks = new Set(scenario.drive ? scans : axis.breaks),
    exact = new Set(extra);
  const grid = Array.from({length: Math.floor((stop / h) * (1 + 1e-12)) + 1}, (_, i) => i * h);
  const kept = [];
  for (const t of [...grid, ...extra.filter((at) => at <= stop)].sort((a, b) => a - b)) {
    const last = kept.at(-1);
    if (kept.length && t - last <= CLOSE * h) {
      if (exact.has(t) && !breaks.has(last)) kept[kept.length - 1] = t;
    } else {
      kept.push(t);
    }
  }
  return kept;
}

/** What the scripted axis gives for a step: the motion of the master, wrapped if it is a rotary one. */
function masterInputs(scenario, axis, t, end) {
  const period = scenario.start["master.period"] ?? 0,
    mode = scenario.start["master.input_mode"] ?? START_OF_STEP;
  const [p, v, a] = mode === END_OF_STEP && end > t ? axis.until(end) : axis.at(t);
  return {"master.position": period ? modulo(p, period) : p, "master.velocity": v, "master.acceleration": a};
}

/** The recorded points of a run: the block's variables, and the motion of the scripted axis, without wrapping. */
class Course {
  /** `room`: the rows of a run that is no longer needed; to fill new memory takes longer than the run itself. */
  constructor(unit, room) {
    this.places = unit.places;
    this.width = unit.names.length + 3;
    this.rows = room ?? new Float64Array(512 * this.width);
    this.time = [];
    this.lines = [];
    this.columns = new Map();
  }

  get count() {
    return this.time.length;
  }

  add(t, values, motion) {
    const at = this.count * this.width,
      end = at + this.width;
    if (end > this.rows.length) {
      const more = new Float64Array(2 * this.rows.length);
      more.set(this.rows);
      this.rows = more;
    }
    this.rows.set(values, at);
    for (let order = 0; order < 3; order++) this.rows[end - 3 + order] = motion[order];
    this.time.push(t);
  }

  /** A variable at all points. */
  column(name) {
    return this.#at(this.places.get(name));
  }

  value(name, k) {
    return this.rows[k * this.width + this.places.get(name)];
  }

  /** Position (0), velocity (1) or acceleration (2) of the scripted axis at all points. */
  axis(order) {
    return this.#at(this.width - 3 + order);
  }

  #at(place) {
    if (!this.columns.has(place)) {
      const found = new Float64Array(this.count);
      for (let k = 0, i = place; k < found.length; k++, i += this.width) found[k] = this.rows[i];
      this.columns.set(place, found);
    }
    return this.columns.get(place);
  }
}

/**
 * A whole run of a scenario. `cycle(t, unit, motion)`: a program that may set the block before each step but the first,
 * since what is set at 0 is a start value; `normals`, `room`: see Telegrams and Course. The course ends before a refused step; then `refused` is true, and the last line tells why.
 */
function run(unit, scenario, {cycle = null, normals = {}, room = null} = {}) {
  const {step_size: h, stop_time: stop} = scenario;
  if (!(h > 0 && stop > 0 && stop / h <= MOST_STEPS)) {
    throw new Error(`step size = ${h} s is not allowed: a run up to ${stop} s has 1 to ${MOST_STEPS} steps`);
  }
  const axis = new Script(scenario.drive ? onlyBegin(scenario.axis) : scenario.axis);
  const starts = (name) => scenario.start[name] ?? unit.kinds.get(name).start;
  const remote = scenario.remote && new Telegrams(scenario.remote, axis, starts, stop, normals);
  const inputs = (t, end) => (remote ? remote.inputs(t, end) : masterInputs(scenario, axis, t, end));
  const program = new Program(scenario, axis, starts),
    course = new Course(unit, room),
    begun = performance.now();
  Object.assign(course, {scenario, script: axis, telegrams: remote, program, refused: false, given: []});
  const hear = (t) => course.lines.push(...unit.lines.splice(0).map((line) => ({t, ...line})));
  unit.begin();
  unit.set({...scenario.start, ...inputs(0, 0)});
  course.refused = unit.initialize() !== 0;
  hear(0);
  if (!course.refused) {
    course.add(0, unit.values(), axis.at(0));
    program.begin(unit);
    walk(unit, scenario, {axis, program, course, inputs, cycle, hear});
  }
  course.spent = performance.now() - begun;
  return course;
}

function onlyBegin({position = 0, velocity = 0}) {
  return {position, velocity};
}

/** The steps, one by one. Where a step ends depends on what the program sees at the end of the one before. */
function walk(unit, scenario, {axis, program, course, inputs, cycle, hear}) {
  const close = CLOSE * scenario.step_size,
    known = points(scenario, axis, program.scans);
  const watched = cycle && watching(unit, course);
  for (let t = known[0], i = 1; i < known.length;) {
    const changed = program.take(t + close);
    let end = Math.min(program.nextLook, program.nextSetting);
    if (end >= known[i] - close) end = known[i++];
    unit.set(inputs(t, end));
    unit.set(changed);
    if (cycle && t > 0) watched(t, () => cycle(t, unit, axis.at(t)));
    course.refused = unit.step(end - t) !== 0;
    if (unit.lines.length) hear(t);
    if (course.refused) return;
    course.add(end, unit.values(), axis.until(end));
    if (program.nextLook <= end + close) program.look(unit);
    t = end;
  }
}

/** Keeps in `course.given` what a cycle sets that is not there yet. */
function watching(unit, course) {
  const set = unit.set.bind(unit);
  return (t, act) => {
    const values = {};
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
    if (Object.keys(values).length) course.given.push({at: t, values});
  };
}

/** SHA-256 of these variables at all points of a run, point by point. */
async function fingerprint(course, names) {
  const places = names.map((name) => course.places.get(name)),
    kept = new Float64Array(course.count * places.length);
  for (let k = 0, at = 0; k < course.count; k++) {
    for (const place of places) kept[at++] = course.rows[k * course.width + place];
  }
  const digest = await crypto.subtle.digest("SHA-256", kept);
  return Array.from(new Uint8Array(digest), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
