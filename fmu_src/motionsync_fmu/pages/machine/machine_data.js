"use strict";
// What the animated machine draws: `sceneOf` makes it of the course of a run, for a report as for a page that runs the block.
// A course has the `scenario`, the `time` of its points in s, at these points `column(name)`, any variable of the block, and
// `axis(order)`, the scripted axis without wrapping; of a remote axis also its `errors`, at all points but the first.
//
// A signal has the columns `t`, s, and `x`. With slopes `v`, it is smooth: the cubic between two points that has their values
// and slopes (Hermite). Without, each value holds until the next one.

const FINENESS = 2e-7; // of the range of what is drawn, to which numbers are shown
const AXIS_MARGIN = 0.06; // of a linear axis' range, beside it at both ends
const BELT_MARGIN = 0.14, // of the carriage's range, beside it at both ends
  OUTFEED = 0.7, // of that range, the most that is shown of the pieces that have been cut off
  REACH = 1, // of that range, in which an end position is worth showing
  LEAST = 1e-3; // of the master's travel: the least range, for a carriage at rest
const USUAL = 0.98, // the share of the errors that the window of a remote axis shows
  WINDOW_MARGIN = 1.6; // its half width, as a multiple of the greatest usual error

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
    this.master = course.axis(0);
  }

  values(name) {
    return this.course.column(name);
  }

  start(name) {
    return this.scenario.start[name] ?? this.declared.get(name)?.start ?? 0;
  }

  /** Where one of these conditions holds (pages/machine/description.py): 1, or 0. */
  where(conditions) {
    const all = conditions.map((condition) => {
      const [name, member] = condition.split(" == ");
      const number = member && this.declared.get(name).choices.find(([, text]) => text === member)[0];
      return [this.values(name), number];
    });
    return this.master.map((_, k) =>
      all.some(([values, number]) => (number === undefined ? values[k] !== 0 : values[k] === number)) ? 1 : 0,
    );
  }

  /** The first of these start values that is not 0; `a unless b`: not if `b` is set. */
  period(names) {
    const values = names.map((text) => {
      const [name, other] = text.split(" unless ");
      return other && this.start(other) ? 0 : this.start(name);
    });
    return values.find((x) => x) ?? 0;
  }

  /** Any variable over time. */
  signal(name) {
    return this.declared.get(name).start === undefined ? this.heldOf(name) : this.setting(name);
  }

  /** The points at which a value changes: the picture moves from the time of the change on. */
  held(values) {
    const points = [...values.keys()].filter((k) => !k || values[k] !== values[k - 1]);
    return {t: points.map((k) => this.time[k]), x: points.map((k) => values[k])};
  }

  heldOf(name) {
    return this.held(this.values(name));
  }

  /** A parameter or input over time: what is set at a time is recorded at the next point. */
  setting(name) {
    return {t: this.time.subarray(0, -1), x: this.values(name).subarray(1)};
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

/** What the machine draws of a run of at least two points; null: nothing. */
function sceneOf(course, block) {
  const run = new Run(course, block);
  if (course.scenario.remote) return remoteAxis(run);
  const picture = block.pictures.find(({where}) => !where || run.start(where));
  if (!picture) return null;
  return {axes: twoAxes, belt, cylinder}[picture.scene](run, picture);
}

// --- two axes that may be coupled ---

const FREE = 0, CHANGING = 1, COUPLED = 2;

function twoAxes(run, picture) {
  const [coupled, changing] = [run.where(picture.coupled), run.where(picture.changing)];
  const coupling = coupled.map((x, k) => (x ? COUPLED : changing[k] ? CHANGING : FREE));
  const periods = [run.period(picture.master_period), run.period(picture.slave_period)];
  const marks = [picture.master_marks ?? [], picture.slave_marks ?? []].map((list) => list.map((mark) => drawnMark(run, mark)));
  const positions = unwrapped(run, periods[1]);
  let ranges = [rangeOf(run.master), rangeOf(positions)];
  if (!periods.some((period) => period) && alike(...ranges)) {
    const both = [Math.min(ranges[0][0], ranges[1][0]), Math.max(ranges[0][1], ranges[1][1])];
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

function drawnMark(run, mark) {
  const drawn = {label: mark.label};
  for (const key of ["at", "from", "to"]) if (key in mark) drawn[key] = run.signal(mark[key]);
  if (mark.shown) drawn.shown = run.held(run.where(mark.shown));
  return drawn;
}

function rangeOf(positions) {
  const low = least(positions), high = greatest(positions);
  const margin = Math.max(AXIS_MARGIN * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1));
  return [low - margin, high + margin];
}

/** Whether two ranges can be drawn in one scale. */
function alike(first, second) {
  const shorter = Math.min(first[1] - first[0], second[1] - second[0]);
  return Math.max(first[1], second[1]) - Math.min(first[0], second[0]) <= 3 * shorter * (1 + FINENESS);
}

/** The slave's positions without turns: each in the turn nearest to where its velocities lead from the one before. */
function unwrapped(run, period) {
  const values = run.values("slave.position"), velocity = run.values("slave.velocity"), {time} = run;
  if (!period) return values;
  let turns = 0;
  return values.map((x, k) => {
    const expected = k && 0.5 * (time[k] - time[k - 1]) * (velocity[k - 1] + velocity[k]);
    if (k) turns += Math.round((x - values[k - 1] - expected) / period);
    return x - turns * period;
  });
}

// --- moving material, and a carriage beside it ---

/** The intervals in which a condition holds: first point, and the one after the last. */
function intervals(on) {
  const ranges = [];
  for (let k = 0, first = -1; k <= on.length; k++) {
    if (k < on.length && on[k]) {
      if (first < 0) first = k;
    } else if (first >= 0) {
      ranges.push([first, k]);
      first = -1;
    }
  }
  return ranges;
}

const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;

/** The cuts of a run in which the Boolean of the table [cuts] is true: begin, end, the nearest mark, the place. */
function cutsOf(run) {
  const {while: name, length, offset = 0, ratio = 1} = run.scenario.cuts, slave = run.values("slave.position");
  const places = run.master.map((m, k) => m - slave[k] / ratio);
  return intervals(run.values(name)).map(([first, after]) => {
    const inside = places.subarray(first, after), mark = offset + Math.round((mean(inside) - offset) / length) * length;
    const error = inside.reduce((worst, x) => (Math.abs(x - mark) > Math.abs(worst) ? x - mark : worst), 0);
    return {begin: run.time[first], end: run.time[after - 1], mark, place: mark + error};
  });
}

function belt(run, picture) {
  const spec = run.scenario.cuts.while ? run.scenario.cuts : null,
    pieces = run.block.piece_variables ? piecesOf(run) : null;
  const down = spec ? run.values(spec.while) : run.where(picture.down), ratio = ratioOf(run, picture, spec);
  const pitches = (pieces ?? []).map(({begin, end}) => end - begin).sort((a, b) => a - b);
  const middle = pitches.length ? (pitches[(pitches.length - 1) >> 1] + pitches[pitches.length >> 1]) / 2 : 0;
  const drawn = carriage(run, down, ratio, spec ? spec.length : middle);
  return {
    ...drawn,
    tool: picture.tool,
    marks: marksOf(run, picture, {spec, pieces, span: drawn.span}),
    home: homeOf(run, picture),
    zone: picture.zone
      ? picture.zone.map((name) => run.start(name))
      : zone(run, picture.in_sync ? run.where(picture.in_sync) : down),
    ...(pieces ? drawnPieces(run, pieces, ({cut}) => cut) : {cuts: spec ? cutsOf(run) : []}),
  };
}

/** The pieces, their cuts, and the velocity that the block asks the line for; `times`: when the cut of a piece begins and ends. */
function drawnPieces(run, pieces, times) {
  return {
    pieces: pieces.map(({cut, reported, sync, ...shown}) => shown),
    cuts: pieces.map((piece) => {
      const [begin, end] = times(piece);
      return {begin, end, place: piece.end, mark: piece.end};
    }),
    request: run.heldOf(run.block.piece_variables.request),
  };
}

/** The slave's travel over the master's: that of the marks, of the pieces, or of the block's first coupling. */
function ratioOf(run, picture, spec) {
  if (spec) return spec.ratio ?? 1;
  if (!picture.ratio) return factorOf(run);
  if (run.declared.get(picture.ratio).start !== undefined) return run.start(picture.ratio);
  return run.values(picture.ratio).find((x) => x !== 0) ?? 1;
}

function homeOf(run, picture) {
  if (picture.home_used && !run.values(picture.home_used).some((x) => x !== 0)) {
    return {at: run.values("slave.position")[0], label: "start"};
  }
  return {at: run.start(picture.home), label: picture.home_label ?? "home"};
}

/** The marks of the scenario, the block's next cut, or where the products are. */
function marksOf(run, picture, {spec, pieces, span: drawn}) {
  if (spec) return {offset: spec.offset ?? 0, length: spec.length};
  if (picture.next_cut) return {next: run.held(nextCuts(run, picture, pieces)), shown: run.heldOf(picture.next_cut_shown)};
  return picture.product_distance ? {places: productsOf(run, picture, drawn)} : null;
}

/** How far the master, as the block takes it, is off from the true one: turns do not count. */
function masterErrors(course) {
  const taken = course.column("master.smoothed_position"), period = course.scenario.start["master.period"] ?? 0;
  return course.axis(0).map((x, k) => taken[k] - x).map((off) => (period ? off - period * Math.round(off / period) : off));
}

/** Where the products are: the slave meets each at the beginning of its zone, where the block has the master. */
function productsOf(run, picture, drawn) {
  const missing = run.values(picture.product_distance), before = run.start(picture.zone[0]) / run.start(picture.ratio);
  const off = masterErrors(run.course);
  const meetings = [...run.master.map((m, k) => m + off[k] + missing[k])].filter((_, k) => missing[k] > 0);
  const places = [...new Set(meetings.map((m) => Number(m.toFixed(6)) - before))].sort((a, b) => a - b);
  return places.filter((place, i) => !i || place - places[i - 1] > 1e-6 * drawn);
}

/** The slave's travel over the master's at the first cut of a run; without one, at its end. */
function factorOf(run) {
  const factors = run.values(run.block.piece_variables.coupling_factor),
    at = run.values(run.block.piece_variables.cutting).findIndex((x) => x !== 0);
  return factors[at < 0 ? factors.length - 1 : at] || 1;
}

/** How far the tool is beyond the place where it cuts, along the material and in the slave's unit. */
function toolTravel(run, names) {
  const slave = run.values("slave.position");
  if (!names.cut_spacing) return slave;
  const spacings = run.values(names.cut_spacing), radii = run.values(names.edge_radius);
  return slave.map((s, k) => {
    const travel = s - spacings[k] * Math.round(s / spacings[k]);
    return radii[k] > 0 ? radii[k] * Math.sin(travel / radii[k]) : travel;
  });
}

/** The pieces of a run, in the order in which they were cut off. */
function piecesOf(run) {
  const names = run.block.piece_variables,
    counter = run.values(names.pieces),
    factors = run.values(names.coupling_factor);
  const tool = toolTravel(run, names), places = run.master.map((m, k) => m - tool[k] / (factors[k] || 1));
  const [material, calibration] = names.factors.map((name) => run.values(name));
  const removed = run.values(names.kerf), correction = run.values(names.correction);
  const running = run.values(names.running), cutting = run.values(names.cutting);
  const kinds = new Map(run.declared.get(names.kind).choices.map(([n, name]) => [n, name])), pieces = [];
  for (let at = 1, before = 0, total = 0; at < counter.length; at++) {
    const rise = counter[at] < counter[at - 1] ? counter[at] : counter[at] - counter[at - 1];
    if (!rise) continue;
    total += rise;
    let first = at;
    while (first > before && cutting[first - 1]) first--;
    const seen = first < at, end = seen ? mean(places.subarray(first, at)) : places[at];
    const length = run.values(names.length)[at], kind = run.values(names.kind)[at];
    const last =
      rise === 1 && pieces.length && running.subarray(before, at + 1).every((x) => x !== 0) ? pieces.at(-1) : null;
    const begin = last ? last.end : end - (length + (removed[at] + correction[at])) / (material[at] * calibration[at]);
    const cut = seen ? [run.time[first], run.time[at - 1]] : [run.time[at], run.time[at]];
    const sync = run.values(names.time)[at];
    pieces.push({number: total, begin, end, kind, name: kinds.get(kind), length, cut, sync, reported: run.time[at]});
    before = at;
  }
  return pieces;
}

/** Where the next cut is due at each point, 0 where it is not determined: in the turn in which it is made, or else in that of
 * the master. */
function nextCuts(run, picture, pieces) {
  const period = run.start("master.period"), determined = run.values(picture.next_cut_shown);
  let next = 0; // the piece that is reported next
  return run.values(picture.next_cut).map((place, k) => {
    while (pieces[next]?.reported <= run.time[k]) next++;
    if (!determined[k] || !period) return determined[k] ? place : 0;
    return place + period * Math.round(((pieces[next]?.end ?? run.master[k]) - place) / period);
  });
}

/** The carriage and its window, `length` being that of the pieces that are cut. */
function carriage(run, down, ratio, length) {
  const positions = run.values("slave.position"), {roles} = run.block;
  let low = least(positions), high = greatest(positions);
  const travel = span(run.master), places = [roles.MIN_POSITION, roles.MAX_POSITION].map((name) => (name ? run.start(name) : Infinity));
  const stroke = furthest(places.map((end) => end - low)), isAtRest = high - low < LEAST * travel;
  const reach = isAtRest && stroke < travel ? stroke : Math.max(high - low, LEAST * travel, 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1));
  const ends = places.map((end, i) => (Math.abs(end - [low, high][i]) <= REACH * reach ? end : null)),
    shown = ends.filter((place) => place !== null);
  low = Math.min(low, ...shown, high - reach);
  high = Math.max(high, ...shown, low + reach);
  const margin = BELT_MARGIN * (high - low), outfeed = Math.min(Math.abs(ratio) * length, OUTFEED * (high - low));
  const flowsDown = ratio * (run.master.at(-1) - run.master[0]) < 0;
  const window = [low - margin - (flowsDown ? outfeed : 0), high + margin + (flowsDown ? 0 : outfeed)];
  const fastest = Math.max(furthest(run.values("slave.velocity")), Math.abs(ratio) * furthest(run.course.axis(1)));
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

// --- a cylinder with blades above moving material ---

function cylinder(run, picture) {
  const [turn, circumference, blades, park] = ["turn", "circumference", "blades", "park"].map((key) => run.start(picture[key]));
  const ratio = run.start(run.block.piece_variables.factors[0]), pieces = piecesOf(run);
  const [name, member] = picture.along_material.split(" == ");
  const edge = (furthest(run.values("slave.velocity")) * circumference) / turn;
  return {
    ...run.axes(unwrapped(run, turn), turn),
    scene: "cylinder",
    turn,
    circumference,
    blades,
    park: park || (0.5 * turn) / blades,
    ratio,
    sync: Object.fromEntries(["before", "after", "overspeed"].map((key) => [key, run.signal(picture[key])])),
    along_material: run.start(name) === run.declared.get(name).choices.find(([, text]) => text === member)[0],
    in_sync: run.held(run.where(picture.in_sync)),
    fastest: Math.max(edge, Math.abs(ratio) * furthest(run.course.axis(1))),
    marks: {next: run.held(nextCuts(run, picture, pieces)), shown: run.heldOf(picture.next_cut_shown)},
    ...drawnPieces(run, pieces, ({sync}) => [sync, sync]),
  };
}

// --- an axis on another controller ---

function remoteAxis(run) {
  const {errors} = run.course, sorted = errors.position.map(Math.abs).sort((a, b) => a - b);
  const at = USUAL * (sorted.length - 1), below = Math.floor(at), above = Math.ceil(at);
  const usual = sorted[below] + (at - below) * (sorted[above] - sorted[below]);
  const half = WINDOW_MARGIN * Math.max(usual, 1e-9 * span(run.master), 1e-9);
  const of = (x) => ({t: errors.time, x});
  return {
    ...run.common(2 * half),
    scene: "window",
    half,
    within: FINENESS * half,
    true: {t: run.time, x: run.master, v: run.course.axis(1)},
    slave: run.heldOf("slave.position"),
    telegram: of(errors.position),
    corrected: of(errors.corrected_position),
    telegram_index: of(errors.index),
    corrected_index: of(errors.corrected_index),
  };
}
