"use strict";
// What the animated machine draws, from a run in the page. It is what the package pages/machine makes of a recording; but
// all points are kept, since nothing has to be written to a file.

const FINENESS = 2e-7; // of the range of what is drawn, to which numbers are told
const AXIS_ROOM = 0.06; // of a linear axis' range, beside it at both ends
const BELT_ROOM = 0.14,
  OUTFEED = 0.7,
  REACH = 1,
  LEAST = 1e-3; // as in belt.py
const USUAL = 0.98,
  WINDOW_ROOM = 1.6; // as in remote_axis.py

const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const greatest = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
const furthest = (values) => values.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
const span = (values) => greatest(values) - least(values);

/** A run, asked for signals and values; `block`: what the page knows of the block. */
class Run {
  constructor(course, block) {
    Object.assign(this, {course, block, scenario: course.scenario, time: course.time});
    this.declared = new Map(block.variables.map((v) => [v.name, v]));
    this.units = block.units[course.scenario.units];
    this.settings = [...course.program.set, ...course.given].sort((a, b) => a.at - b.at);
    this.master = course.axis(0);
  }

  values(name) {
    return this.course.column(name);
  }

  start(name) {
    return this.scenario.start[name] ?? this.declared.get(name).start;
  }

  /** A value at each point: `told(x)` of the variable's values. */
  where(name, told) {
    return this.values(name).map((x) => (told(x) ? 1 : 0));
  }

  isMember(name, ...members) {
    const numbers = this.declared
      .get(name)
      .choices.filter(([, text]) => members.includes(text))
      .map(([n]) => n);
    return this.where(name, (x) => numbers.includes(x));
  }

  held(values) {
    return {t: this.time, x: values};
  }

  heldOf(name) {
    return this.held(this.values(name));
  }

  /** A parameter or input over time: its start value, and what the run set it to. */
  setting(name) {
    const given = this.settings.filter((s) => name in s.values);
    return {t: [0, ...given.map((s) => s.at)], x: [this.start(name), ...given.map((s) => s.values[name])]};
  }

  /** The same at all points: what is set at a time shows from the next point on. */
  reading(name) {
    if (this.declared.get(name).start === undefined) return this.values(name);
    const {t, x} = this.setting(name);
    return Float64Array.from(this.time, (now) => x[Math.max(bisect(t, now - CLOSE, false) - 1, 0)]);
  }

  common(drawn) {
    return {
      stop: this.time.at(-1),
      span: drawn,
      unit: this.units.POSITION,
      slave_unit: this.slaveUnit,
      state: this.heldOf("state"),
      states: Object.fromEntries(this.declared.get("state").choices.map(([n, name, meaning]) => [n, [name, meaning]])),
    };
  }

  get slaveUnit() {
    return this.units[this.declared.get("slave.position").unit];
  }

  axes(positions, drawn) {
    return {
      ...this.common(drawn),
      within: FINENESS * drawn,
      master: {t: this.time, x: this.master, v: this.course.axis(1)},
      slave: {t: this.time, x: positions, v: this.values("slave.velocity")},
    };
  }
}

/** What the machine draws of a run of at least two points; of a block that has no picture of its own: both axes. */
function sceneOf(course, block) {
  const scenes = {
    CutToLength: cutToLength,
    FlyingSaw: flyingSaw,
    Gearing: gearing,
    RemoteSync: remoteAxis,
    Synchronizer: synchronizer,
    Follower: (run) => (run.start("slave_cycle") ? cyclicFollower(run) : linearFollower(run)),
  };
  return (scenes[block.name] ?? plainAxes)(new Run(course, block));
}

// --- two axes that may be coupled ---

const FREE = 0,
  CHANGING = 1,
  COUPLED = 2;

function synchronizer(run) {
  const period = run.start("master.period"),
    moving = run.values("syn_ramp_on"),
    on = run.values("syn_synchronized");
  const waiting = run.isMember("state", "EXECUTING", "STACKED");
  const coupling = on.map((x, k) => (x ? COUPLED : moving[k] ? CHANGING : FREE));
  const shown = run.held(waiting.map((x, k) => (x || moving[k] ? 1 : 0)));
  const ramp = {label: "ramp", from: run.heldOf("local.ramp_begin"), to: run.heldOf("local.ramp_end"), shown};
  const rest = {label: "rest", at: run.setting("rest_value")};
  return twoAxes(run, [period, period], coupling, [[ramp], [rest]]);
}

function gearing(run) {
  const changing = run.isMember("state", "GEAR_IN", "GEAR_OUT");
  const line = run.isMember("state", "ACTIVE", "WAITING_FOR_STOPPOSITION");
  const waiting = run.isMember("state", "WAITING_FOR_STARTPOSITION", "WAITING_FOR_STOPPOSITION");
  const shown = run.held(waiting.map((x, k) => (x || changing[k] ? 1 : 0)));
  const trigger = {label: "trigger", at: run.heldOf("local.trigger_position"), shown};
  const coupling = line.map((x, k) => (x ? COUPLED : changing[k] ? CHANGING : FREE));
  return twoAxes(run, [run.start("master.period"), run.start("slave.period")], coupling, [[trigger], []]);
}

function cyclicFollower(run) {
  const changing = run.isMember("state", "M_FOLLOWING", "M_HOMING"),
    on = run.isMember("state", "M_SYNCHRONIZED");
  const coupling = on.map((x, k) => (x ? COUPLED : changing[k] ? CHANGING : FREE));
  const meeting = {
    label: "meeting",
    at: run.heldOf("local.meeting_position"),
    shown: run.heldOf("local.meeting_known"),
  };
  const arc = {label: "in sync", from: run.setting("sync_slave"), to: run.setting("sync_out")};
  const park = {label: "park", at: run.setting("park_slave")};
  const cycle = run.start("master.period") || (run.start("variable_cycle") ? 0 : run.start("master_cycle"));
  return twoAxes(run, [cycle, run.start("slave_cycle")], coupling, [[meeting], [arc, park]]);
}

function plainAxes(run) {
  return twoAxes(
    run,
    [run.scenario.start["master.period"] ?? 0, 0],
    run.master.map(() => FREE),
    [[], []],
  );
}

function twoAxes(run, periods, coupling, marks) {
  const positions = unwrapped(run.values("slave.position"), periods[1]);
  let ranges = [rangeOf(run.master), rangeOf(positions)];
  if (!periods[0] && !periods[1] && alike(...ranges)) {
    const both = [least(ranges.map(([low]) => low)), greatest(ranges.map(([, high]) => high))];
    ranges = [both, both];
  }
  const axes = ["master", "slave"].map((name, i) => ({
    name,
    unit: [run.units.POSITION, run.slaveUnit][i],
    period: periods[i],
    range: ranges[i],
    marks: marks[i],
  }));
  const drawn = periods[1] || ranges[1][1] - ranges[1][0];
  return {...run.axes(positions, drawn), scene: "axes", axes, coupling: run.held(coupling)};
}

function rangeOf(positions) {
  const low = least(positions),
    high = greatest(positions);
  const room = Math.max(AXIS_ROOM * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1));
  return [low - room, high + room];
}

/** Whether two ranges can be drawn in one scale. */
function alike(first, second) {
  const shorter = Math.min(first[1] - first[0], second[1] - second[0]);
  return Math.max(first[1], second[1]) - Math.min(first[0], second[0]) < 3 * shorter;
}

/** Positions without the jumps by a period; period 0: as they are. */
function unwrapped(values, period) {
  if (!period) return values;
  let turns = 0;
  return values.map((x, k) => {
    if (k) turns -= Math.round((x - values[k - 1]) / period);
    return x + turns * period;
  });
}

// --- moving material, and a carriage beside it ---

/** The intervals in which a condition holds: first point, and the one after the last. */
function intervals(on) {
  const found = [];
  for (let k = 0, first = -1; k <= on.length; k++) {
    if (k < on.length && on[k]) {
      if (first < 0) first = k;
    } else if (first >= 0) {
      found.push([first, k]);
      first = -1;
    }
  }
  return found;
}

const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;

/** The cuts of a run in which the Boolean of the table [cuts] is true: begin, end, the nearest mark, the place. */
function cutsOf(run) {
  const {while: name, length, offset = 0, ratio = 1} = run.scenario.cuts,
    slave = run.values("slave.position");
  const places = run.master.map((m, k) => m - slave[k] / ratio);
  return intervals(run.values(name)).map(([first, after]) => {
    const inside = places.subarray(first, after),
      mark = offset + Math.round((mean(inside) - offset) / length) * length;
    const error = inside.reduce((worst, x) => (Math.abs(x - mark) > Math.abs(worst) ? x - mark : worst), 0);
    return {begin: run.time[first], end: run.time[after - 1], mark, place: mark + error};
  });
}

function flyingSaw(run) {
  const spec = run.scenario.cuts.while ? run.scenario.cuts : null;
  const down = run.values(spec ? spec.while : "in_sync"),
    coupled = run.values("coupling_factor").find((x) => x !== 0);
  const homed = run.values("move_absolute.busy").some((x) => x !== 0);
  return {
    ...belt(run, down, spec ? (spec.ratio ?? 1) : (coupled ?? 1), spec ? spec.length : 0),
    tool: "saw",
    marks: spec ? {offset: spec.offset ?? 0, length: spec.length} : null,
    cuts: spec ? cutsOf(run) : [],
    home: {
      at: homed ? run.start("move_absolute.position") : run.values("slave.position")[0],
      label: homed ? "home" : "start",
    },
    zone: zone(run, down),
  };
}

function cutToLength(run) {
  const pieces = piecesOf(run),
    pitches = pieces.map(({begin, end}) => end - begin).sort((a, b) => a - b);
  const middle = pitches.length ? (pitches[(pitches.length - 1) >> 1] + pitches[pitches.length >> 1]) / 2 : 0;
  return {
    ...belt(run, run.values("tool.blade_down"), factorOf(run), middle),
    tool: "saw",
    marks: {next: nextCuts(run, pieces), known: run.heldOf("next_cut.known")},
    cuts: pieces.map(({cut, told, end}) => ({
      begin: cut ? cut[0] : told,
      end: cut ? cut[1] : told,
      place: end,
      mark: end,
    })),
    pieces: pieces.map(({cut, told, ...drawn}) => drawn),
    request: run.heldOf("line.velocity_request"),
    home: {at: run.start("home_position"), label: "home"},
    zone: zone(run, run.values("in_sync")),
  };
}

/** The slave's travel over the master's at the first cut of a run; without one, at its end. */
function factorOf(run) {
  const factors = run.values(run.block.books.coupling_factor),
    at = run.values(run.block.books.cutting).findIndex((x) => x !== 0);
  return factors[at < 0 ? factors.length - 1 : at] || 1;
}

/** The pieces of a run, in the order in which they were cut off. */
function piecesOf(run) {
  const {books} = run.block,
    counter = run.values(books.pieces),
    factors = run.values(books.coupling_factor);
  const slave = run.values("slave.position"),
    places = run.master.map((m, k) => m - slave[k] / (factors[k] || 1));
  const [material, calibration] = books.factors.map((name) => run.reading(name));
  const removed = run.reading(books.kerf),
    correction = run.reading(books.correction);
  const running = run.values(books.running),
    cutting = run.values(books.cutting);
  const kinds = new Map(run.declared.get(books.kind).choices.map(([n, name]) => [n, name])),
    found = [];
  for (let at = 1, before = 0, total = 0; at < counter.length; at++) {
    const rise = counter[at] < counter[at - 1] ? counter[at] : counter[at] - counter[at - 1];
    if (!rise) continue;
    total += rise;
    let first = at;
    while (first > before && cutting[first - 1]) first--;
    const seen = first < at,
      end = seen ? mean(places.subarray(first, at)) : places[at];
    const length = run.values(books.length)[at],
      kind = run.values(books.kind)[at];
    const last =
      rise === 1 && found.length && running.subarray(before, at + 1).every((x) => x !== 0) ? found.at(-1) : null;
    const begin = last ? last.end : end - (length + (removed[at] + correction[at])) / (material[at] * calibration[at]);
    const cut = seen ? [run.time[first], run.time[at - 1]] : null;
    found.push({number: total, begin, end, kind, name: kinds.get(kind), length, cut, told: run.time[at]});
    before = at;
  }
  return found;
}

/** Where the next cut is due: in the turn in which it is made, or else in that of the master. */
function nextCuts(run, pieces) {
  const period = run.start("master.period"),
    known = run.values("next_cut.known"),
    told = pieces.map((piece) => piece.told);
  const places = run.values("next_cut.position").map((place, k) => {
    if (!known[k] || !period) return known[k] ? place : 0;
    const near = pieces[bisect(told, run.time[k], true)]?.end ?? run.master[k];
    return place + period * Math.round((near - place) / period);
  });
  return run.held(places);
}

function linearFollower(run) {
  const [ratio, sync, out] = ["k_slave_master", "sync_slave", "sync_out"].map((name) => run.start(name));
  const missing = run.values("master_to_sync"),
    base = belt(run, run.isMember("state", "M_SYNCHRONIZED"), ratio);
  const meetings = [...run.master.map((m, k) => m + missing[k])].filter((_, k) => missing[k] > 0);
  const places = [...new Set(meetings.map((m) => Number(m.toFixed(6)) - sync / ratio))].sort((a, b) => a - b);
  return {
    ...base,
    tool: "gripper",
    marks: {places: places.filter((place, i) => !i || place - places[i - 1] > 1e-6 * base.span)},
    cuts: [],
    home: {at: run.start("park_slave"), label: "park"},
    zone: [sync, out],
  };
}

/** The carriage and its window, `length` being that of the pieces that are cut. */
function belt(run, down, ratio, length = 0) {
  const positions = run.values("slave.position"),
    {roles} = run.block;
  let low = least(positions),
    high = greatest(positions);
  const reach = Math.max(high - low, LEAST * span(run.master), 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1));
  const end = (name, nearest) =>
    name && Math.abs(run.start(name) - nearest) <= REACH * reach ? run.start(name) : null;
  const ends = [end(roles.MIN_POSITION, low), end(roles.MAX_POSITION, high)],
    known = ends.filter((place) => place !== null);
  low = Math.min(low, ...known, high - reach);
  high = Math.max(high, ...known, low + reach);
  const room = BELT_ROOM * (high - low),
    outfeed = Math.min(Math.abs(ratio) * length, OUTFEED * (high - low));
  const flowsDown = ratio * (run.master.at(-1) - run.master[0]) < 0;
  const window = [low - room - (flowsDown ? outfeed : 0), high + room + (flowsDown ? 0 : outfeed)];
  const fastest = furthest(run.values("slave.velocity"));
  return {
    ...run.axes(positions, window[1] - window[0]),
    scene: "belt",
    ratio,
    window,
    ends,
    down: run.held(down),
    fastest,
  };
}

/** Where the carriage is while the tool is down. */
function zone(run, down) {
  const inside = run.values("slave.position").filter((_, k) => down[k] !== 0);
  return inside.length ? [least(inside), greatest(inside)] : null;
}

// --- an axis on another controller ---

/** How far telegrams and slave are from the truth, at all points but the first (scenario/telegrams.py). */
function errorsOf(course) {
  const {
      telegrams,
      script,
      scenario: {remote, settings},
    } = course,
    time = course.time.slice(1);
  const slave = course.column("slave.position"),
    corrected = course.column(remote.corrected_index);
  const later = settings.filter((s) => remote.delay in s.values).map((s) => [s.at, s.values[remote.delay]]);
  const delays = [[0, telegrams.delay], ...later.sort((a, b) => a[0] - b[0])];
  const found = {time, index: [], corrected_index: [], position: [], corrected_position: []};
  const wrapped = (x) => x - remote.wraps_at * Math.round(x / remote.wraps_at);
  time.forEach((t, i) => {
    const acted = telegrams.acted(t) - 1,
      instant = acted * telegrams.cycle,
      index = telegrams.trueIndex(instant);
    const [seen, motion] = telegrams.telegram(telegrams.shown(course.time[i], t));
    const delay = delays.findLast(([at]) => at <= instant + 1e-9)[1];
    found.index.push(wrapped(seen - index));
    found.corrected_index.push(wrapped(corrected[i + 1] - index));
    found.position.push(motion[0] - script.at(instant)[0]);
    found.corrected_position.push(slave[i + 1] - script.at(instant + delay - remote.behind * telegrams.nominal)[0]);
  });
  return found;
}

function remoteAxis(run) {
  const found = errorsOf(run.course),
    sorted = found.position.map(Math.abs).sort((a, b) => a - b);
  const at = USUAL * (sorted.length - 1),
    below = Math.floor(at),
    above = Math.ceil(at);
  const usual = sorted[below] + (at - below) * (sorted[above] - sorted[below]);
  const half = WINDOW_ROOM * Math.max(usual, 1e-9 * span(run.master), 1e-9);
  const of = (x) => ({t: found.time, x});
  return {
    ...run.common(2 * half),
    scene: "window",
    half,
    within: FINENESS * half,
    true: {t: run.time, x: run.master, v: run.course.axis(1)},
    slave: run.heldOf("slave.position"),
    telegram: of(found.position),
    corrected: of(found.corrected_position),
    telegram_index: of(found.index),
    corrected_index: of(found.corrected_index),
  };
}
