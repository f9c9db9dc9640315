"use strict";
// The page: what can be changed, and what comes of it. Every change runs the whole scenario anew.

const PROGRAM = "program"; // the choice of the block's own program
const REFRESH = 120; // ms: the table of all values is slow to draw
const SETTLED = 200; // ms without a change, after which the address follows: browsers allow few changes of it
const LINE_VELOCITY = "master.velocity"; // among the main values: that with which the line starts, or to which it ramps up from rest

/** The block: what the page knows of it, its variables by name, the running unit. */
let block, variables, unit;
/** The scenario as it was, and as it is now; the program in the editor; the sliders that it makes, by name. */
let untouched, scenario, program = NO_PROGRAM, sliders = {};
/** Values that the address has for such sliders; whether the address has a program that nobody has looked at yet. */
let givenSliders = {}, isForeign = false;
/** The encoder and the smoothing time that the switch "measured line" puts in: as they were, and as they are. */
let usualLine, measuredLine;
/** The last run that was not refused from the beginning, that of the untouched scenario, the plots, the time that is shown. */
let course = null, before = null, plots, now = 0;
/** Why what is chosen now is refused; "": it is not. Whether that run could not even start, and another one is shown. */
let refusal = "", stale = false;
let asked = false, latestBadge = 0, latestExport = 0, listed = 0, addressing = 0;

const MARKS = "cuts.length", OF_MARKS = "of the marks on the material";

const UNLIMITED = 1e9; // a value from here on limits nothing
const isMain = (name) => block.main.includes(name);
const copy = (thing) => JSON.parse(JSON.stringify(thing));
const own = () =>
  PROGRAMS[block.name] && block.scenarios.some((s) => s.name === PROGRAMS[block.name].scenario)
    ? PROGRAMS[block.name]
    : null;

// --- the choice of a scenario ---

/** Show a scenario; `changes`: places and values as the address has them. */
function choose(name, changes = []) {
  const driven = name === PROGRAM, source = block.scenarios.find((s) => s.name === (driven ? own().scenario : name));
  untouched = copy(source);
  const title = `Driven by the program below: ${source.title}`;
  if (driven) Object.assign(untouched, {settings: [], reactions: [], sha256: "", title});
  complete(untouched);
  scenario = copy(untouched);
  program = driven ? own().text : NO_PROGRAM;
  sliders = {};
  $("sliders").replaceChildren();
  if (!scenario.remote) prepareSwitch();
  takeOver(changes);
  $("program").value = program;
  $("editor").open = program !== NO_PROGRAM;
  $("title").textContent = scenario.title;
  $("exported").hidden = true;
  $("export").setAttribute("aria-expanded", "false");
  plots.zoom = null;
  plots.renew();
  course = null;
  before = changes.length && !driven ? run(unit, resolved(untouched), {normals: block.normals}) : null;
  if (!(before?.count > 1)) before = null;
  controls();
  compute();
}

/** Give a scenario what the page has a control for, by its start value; that changes nothing. */
function complete(of) {
  for (const name of of.axis.times ? [] : ["position", "velocity"]) of.axis[name] ??= 0;
  const isSetLater = (name) => of.settings.some(({values}) => name in values);
  for (const {name, start} of startable(of)) if (isMain(name) && !isSetLater(name)) of.start[name] = start;
}

/** Take over what an address has. */
function takeOver(changes) {
  const values = new Map(changes), text = values.get(PROGRAM);
  isForeign = text !== undefined && text !== program;
  if (isForeign) program = text;
  givenSliders = {};
  for (const [place, x] of changes.filter(([place]) => place !== PROGRAM)) {
    if (place.startsWith("knob/")) givenSliders[place.slice("knob/".length)] = Number(x);
    else put(scenario, place, fromAddress(x));
  }
  for (const name of [scenario.start, ...scenario.settings.map(({values}) => values)].flatMap(Object.keys)) {
    if (!variables.has(name)) throw new Error(`there is no variable ${name}`);
  }
  for (const name of Object.keys(scenario.start)) untouched.start[name] ??= variables.get(name).start;
  if (scenario.encoder) measuredLine.encoder = scenario.encoder;
}

/** Show what the address has; without a scenario, the first one. */
function openAddress() {
  const [[place, name] = [], ...changes] = new URLSearchParams(location.hash.slice(1));
  const isThere = place === "run" && [...$("scenario").options].some((option) => option.value === name);
  const first = block.scenarios[0].name;
  $("scenario").value = isThere ? name : first;
  try {
    choose($("scenario").value, isThere ? changes : []);
    $("unread").textContent = isThere || !place ? "" : `The address asks for ${name}, which this page does not have.`;
  } catch (error) {
    choose($("scenario").value);
    $("unread").textContent = `Not the run of the address: ${error.message}.`;
  }
}

/** What is set, as the address has it. */
function address() {
  const knobs = Object.entries(sliders).filter(([, {value, first}]) => value !== first);
  const source = $("scenario").value === PROGRAM ? own().text : NO_PROGRAM;
  return `#${joined([
    ["run", $("scenario").value],
    ...differences(untouched, scenario),
    ...knobs.map(([name, {value}]) => [`knob/${encodeURIComponent(name)}`, value]),
    ...(program === source ? [] : [[PROGRAM, program]]),
  ])}`;
}

/** Put what is set into the address, a while after the last change. */
function follow() {
  clearTimeout(addressing);
  addressing = setTimeout(() => history.replaceState(null, "", address()), SETTLED);
}

// --- what can be changed ---

/** How far a slider of a value 0 goes: the greatest magnitude in this unit, of those that limit something. */
function usual(of) {
  const {start, settings, axis} = untouched,
    values = [...Object.entries(start), ...settings.flatMap((s) => Object.entries(s.values))];
  const alike = values.filter(([name, x]) => variables.get(name).unit === of && Math.abs(x) < UNLIMITED).map(([, x]) => Math.abs(x));
  const travel = of === "POSITION" || of === "SLAVE_POSITION" ? [span(before?.column("slave.position") ?? [0, 0])] : [];
  return greatest([...alike, ...travel, of === "VELOCITY" ? Math.abs(axis.velocity ?? 0) : 0]) || 100;
}

/** A control of a variable's value; one that limits nothing has no slider. */
function variable(name, values, first, {slider = !(Math.abs(first) >= UNLIMITED), ...limits} = {}) {
  const v = variables.get(name), unitName = block.units[scenario.units][v.unit];
  return control({...v, unit: unitName, ...limits}, values, name, {first, usual: slider ? usual(v.unit) : 0, changed: update});
}

/** A control of a number that is no variable of the block; `firsts`: the values as they were. */
function plainNumber(label, description, [values, firsts], name, {of = "NONE", slider = true, changed = update, ...limits} = {}) {
  const about = {kind: "Real", label, description, unit: block.units[scenario.units][of] ?? of, ...limits};
  return control(about, values, name, {first: firsts[name] ?? values[name], usual: slider ? usual(of) : 0, changed});
}

function controls() {
  const driven = $("scenario").value === PROGRAM; // then the program sets the marks
  const cuts = [scenario.cuts, untouched.cuts];
  const marks = Object.keys(driven ? {} : scenario.cuts)
    .filter((name) => ["length", "offset"].includes(name))
    .filter((name) => !isMain(`cuts.${name}`))
    .map((name) => plainNumber(`cuts.${name}`, OF_MARKS, cuts, name, {of: "POSITION"}));
  const names = Object.keys(scenario.start).filter((name) => name !== SMOOTHING && !isMain(name)); // the others are above
  const starts = names.map((name) => variable(name, scenario.start, untouched.start[name]));
  const runs = [
    ["stop_time", "the end of the run"],
    ["step_size", "the step size, and the cycle of the reactions"],
  ].map(([name, text]) => plainNumber(name, text, [scenario, untouched], name, {of: "s", slider: false, above: 0}));
  $("groups").replaceChildren(
    ...group("Main values", block.main.flatMap(mainRows)),
    ...group("Marks", marks),
    ...group(scenario.remote ? "The remote axis" : "The master", [...switchRows(), newElement("div", {id: "axis-rows"}, ...axisRows())]),
    ...group("Start values", [...starts, another("Another one", startable(scenario), addStart)]),
    ...commandGroup(),
    ...group("Reactions", scenario.reactions.map(reactionRow), false),
    ...group("The run", runs, false),
  );
}

/** What else could be a start value of a scenario. */
function startable(of) {
  const isFree = (v) => v.start !== undefined && !(v.name in of.start) && !scripted(v.name, of) && v.name !== SMOOTHING;
  return block.variables.filter(isFree);
}

/** The controls of one of the main values: of the script, or a start value, and whatever sets it during the run. */
function mainRows(name) {
  const {cuts, axis} = scenario, driven = $("scenario").value === PROGRAM;
  if (name === MARKS) return cuts.length && !driven ? [plainNumber(MARKS, OF_MARKS, [cuts, untouched.cuts], "length", {of: "POSITION"})] : [];
  if (name === LINE_VELOCITY) return hasScript() ? [lineVelocity()] : [];
  const settings = scenario.settings.filter((s) => name in s.values).sort((a, b) => a.at - b.at);
  const rows = settings.map((s) => variable(name, s.values, firstOf(s)[name], {moment: `at ${s.at} s`}));
  const isReplaced = settings.length > 0 && !untouched.start[name]; // not given, or 0: a mere beginning
  return isReplaced ? rows : [variable(name, scenario.start, untouched.start[name]), ...rows];
}

/** Whether the line runs along a script, from a velocity that can be chosen. */
const hasScript = () => !scenario.remote && !scenario.drive && !scenario.axis.times;

/** Whether the line starts from rest, and is described by the velocity to which it ramps up. */
const ramps = () => hasScript() && !untouched.axis.velocity && rampEnd(untouched.axis) !== null;

/** The velocity of the line: that with which it starts, or that to which it ramps up. */
function lineVelocity() {
  const {axis} = scenario, about = {of: "VELOCITY"};
  if (!ramps()) return plainNumber(LINE_VELOCITY, "of the line, at the beginning", [axis, untouched.axis], "velocity", about);
  const {at: t, velocity} = rampEnd(untouched.axis), present = {velocity: new Script(axis).at(t)[1]};
  const description = "of the line, at the end of its first ramp: all its velocities change in proportion, at the same times";
  const row = plainNumber(LINE_VELOCITY, description, [present, {velocity}], "velocity", {
    ...about,
    moment: `from ${decimal(t)} s on`,
    changed: () => {
      scaleTo(axis, untouched.axis, present.velocity);
      $("axis-rows").replaceChildren(...axisRows());
      update();
    },
  });
  row.id = "line-velocity";
  return row;
}

/** What a setting was before it was changed. */
const firstOf = (s) => untouched.settings.find(({at: t}) => t === s.at)?.values ?? {};

function addStart(name) {
  const present = withMeasuredInputs(scenario, block.variables).start[name] ?? variables.get(name).start;
  scenario.start[name] = untouched.start[name] = present; // it changes nothing
  controls();
}

/** A choice of a further variable. */
function another(label, choices, act) {
  const options = choices.map((v) => newElement("option", {value: v.name, title: v.description}, v.name));
  const select = newElement("select", {"aria-label": label}, newElement("option", {value: ""}, "…"), ...options);
  select.onchange = () => select.value && act(select.value);
  return newElement("div", {className: "knob"}, newElement("span", {className: "soft"}, label), select);
}

// --- the measured line ---

/** What the switch puts in: the scenario's own encoder and smoothing time, or usual ones. */
function prepareSwitch() {
  const smoothing = untouched.start[SMOOTHING] ?? variables.get(SMOOTHING).start;
  if (scenario.encoder) scenario.start[SMOOTHING] = untouched.start[SMOOTHING] = smoothing; // it changes nothing
  measuredLine = {encoder: scenario.encoder ?? usualEncoder(scenario, block.ideal_encoder), smoothing};
  usualLine = copy(measuredLine);
}

/** Put the encoder in, as it was left, or take it out. */
function measure(on) {
  const {start} = scenario, first = untouched.start[SMOOTHING];
  if (!on) measuredLine.smoothing = start[SMOOTHING];
  scenario.encoder = on ? measuredLine.encoder : null;
  if (on || first !== undefined) start[SMOOTHING] = on ? measuredLine.smoothing : first;
  else delete start[SMOOTHING];
}

/** The switch, and below it what belongs to an encoder that is there. */
function switchRows() {
  if (scenario.remote) return [];
  const below = newElement("div"), show = () => below.replaceChildren(...encoderRows());
  const about = {kind: "Boolean", label: "measured line", description: "an encoder is between the line and the block"};
  const position = {on: scenario.encoder ? 1 : 0}, first = untouched.encoder ? 1 : 0;
  const changed = (on) => {
    measure(on);
    show();
    update();
  };
  const row = control(about, position, "on", {first, changed});
  row.querySelector("input").disabled = "times" in scenario.axis; // a recorded line has been measured
  show();
  return [row, below];
}

function encoderRows() {
  const {encoder, start, axis} = scenario, rows = [], {smallest, most, longest} = block.runner.encoder;
  const usual = usualEncoder(untouched, block.ideal_encoder);
  const row = (name, description, limits) => {
    const both = [encoder, usualLine.encoder], reach = decimal(UP_TO * (usualLine.encoder[name] || usual[name]));
    rows.push(plainNumber(`encoder.${name}`, description, both, name, {min: 0, strict: true, reach, ...limits}));
  };
  if (encoder && !axis.times) {
    row("resolution", "the position is rounded down to a multiple of it; 0: it is not", {of: "POSITION", max: most, smallest});
    row("noise", "one sigma of white noise", {of: "POSITION", max: most});
    row("delay", "how old a position is", {of: "s", max: longest});
  }
  if (SMOOTHING in start) {
    const reach = decimal(UP_TO * (usualLine.smoothing || variables.get(SMOOTHING).start));
    rows.push(variable(SMOOTHING, start, usualLine.smoothing, {reach}));
  }
  return [...rows, newElement("p", {className: "soft", id: "taken"})];
}

/** How the block takes the line that is measured now. */
function showTaken() {
  if ($("taken")) $("taken").textContent = scenario.encoder ? takenAs(scenario, variables) : "";
}

function axisRows() {
  const {axis, remote, drive} = scenario, first = untouched.axis, rows = [];
  if (axis.times) return [newElement("p", {className: "soft"}, "The line is recorded: measured positions, and straight lines between them.")];
  const of = {position: "POSITION", velocity: "VELOCITY", acceleration: "ACCELERATION", jerk: "JERK", duration: "s"};
  const changed = () => {
    $("line-velocity")?.replaceWith(lineVelocity());
    update();
  };
  for (const name of ["position", "velocity"]) {
    if (name === "velocity" && isMain(LINE_VELOCITY) && hasScript() && !ramps()) continue; // it is above
    rows.push(plainNumber(name, "at the beginning", [axis, first], name, {of: of[name], changed}));
  }
  const segments = (axis.segments ?? []).flatMap((segment, i) => {
    const both = [segment, first.segments[i]], limits = (name) => (name === "duration" ? {min: 0, above: 0} : {});
    const row = (name) =>
      plainNumber(`${i + 1}: ${name}`, `of segment ${i + 1}`, both, name, {of: of[name], changed, ...limits(name)});
    return Object.keys(segment).map(row);
  });
  rows.push(...group("Segments", segments, segments.length < 4));
  if (drive)
    rows.push(newElement("p", {className: "soft"}, `It follows ${drive.follows}, with a lag of ${drive.time_constant} s.`));
  if (!remote) return rows;
  const both = [remote, untouched.remote];
  remote.rates.forEach((rate, i) => {
    const was = untouched.remote.rates[i], label = `sender's cycle${i ? ` from ${rate.at} s on` : ""}`;
    const limits = {min: 0.99 * was.cycle, max: 1.01 * was.cycle, strict: true}; // two clocks that are meant to be alike
    rows.push(plainNumber(label, "", [rate, was], "cycle", {of: "s", ...limits}));
  });
  const phase = "how long before 0 the first telegram is sent, as a share of the sender's cycle";
  rows.push(plainNumber("phase", phase, both, "phase", {min: 0, max: 0.99, strict: true}));
  const jitter = "of sending and receiving, one sigma as a share of the receiver's cycle";
  if (block.normals[remote.seed]) rows.push(plainNumber("jitter", jitter, both, "jitter", {min: 0, max: 0.15, strict: true}));
  return rows;
}

function reactionRow(r, i) {
  const first = untouched.reactions[i] ?? r, when = newElement("div", {className: "when"}, `when ${r.name} ${r.comparison}`);
  const v = variables.get(r.name), discrete = v.kind === "Boolean" || v.choices.length > 0, rows = [];
  if (discrete) when.textContent = `when ${r.when}`;
  else rows.push(plainNumber("value", "", [r, first], "value", {of: v.unit, slider: false}));
  const times = r.times === null ? "each time" : r.times === 1 ? "once" : `${r.times} times`;
  when.append(newElement("span", {className: "soft"}, times));
  rows.push(plainNumber("after", "how long after the scan that sees it", [r, first], "after", {of: "s", slider: false}));
  for (const name of Object.keys(r.set)) rows.push(variable(name, r.set, first.set[name], {slider: false}));
  for (const [name, more] of Object.entries(r.add)) {
    if (more === "cuts.length") rows.push(newElement("p", {className: "soft"}, `${name}: cuts.length more`));
    else {
      const limits = {of: variables.get(name).unit, slider: false};
      rows.push(plainNumber(`${name}: more by`, "", [r.add, first.add], name, limits));
    }
  }
  return newElement("div", {className: "event"}, when, ...rows);
}

// --- commands ---

function commandGroup() {
  const commands = block.variables
    .filter((v) => v.command)
    .map((v) => {
      const button = newElement("button", {type: "button", title: v.description, "aria-pressed": "false"}, v.name);
      button.onclick = () => give(v.name, at(v.name) ? 0 : 1);
      button.dataset.command = v.name;
      return button;
    });
  const others = block.variables.filter(
    (v) => v.start !== undefined && !v.command && v.variability !== "fixed" && !scripted(v.name),
  );
  const rows = [...scenario.settings].sort((a, b) => a.at - b.at).map(settingRow);
  const head = commands.length
    ? [newElement("p", {className: "soft"}, "At the time that is shown:"), newElement("div", {className: "commands"}, ...commands)]
    : [];
  return group("Commands", [...head, another("Set at this time", others, (name) => give(name, at(name))), ...rows]);
}

/** Whether an input comes from the script of the axis. */
function scripted(name, {remote} = scenario) {
  if (remote) return name.startsWith(`${remote.part}.`) || name === remote.cycle_index;
  return ["master.position", "master.velocity", "master.acceleration"].includes(name);
}

/** A value in the step that starts at the time shown. */
function at(name) {
  return course ? course.value(name, Math.min(place(now) + 1, course.count - 1)) : variables.get(name).start;
}

/** One more setting, at the communication point that is shown; the past stays as it is. */
function give(name, value) {
  if (!course) return;
  const t = course.time[Math.min(Math.max(place(now), 1), course.count - 2)];
  let setting = scenario.settings.find((s) => s.at === t);
  if (!setting) scenario.settings.push((setting = {at: t, values: {}}));
  setting.values[name] = value;
  controls();
  update();
}

function settingRow(s) {
  const first = firstOf(s);
  const moment = newElement("input", {type: "number", step: "any", value: s.at, "aria-label": "time of the setting, in s"});
  moment.onchange = () => {
    const t = Number(moment.value), allowed = t > 0 && t < scenario.stop_time;
    refuse(moment, allowed ? "" : `time of the setting = ${moment.value || "nothing"} is not allowed: it must be > 0 and < ${scenario.stop_time}`);
    if (allowed) {
      s.at = t;
      controls();
    }
    update();
  };
  const remove = newElement("button", {type: "button"}, "Remove");
  remove.onclick = () => {
    scenario.settings.splice(scenario.settings.indexOf(s), 1);
    controls();
    update();
  };
  const rows = Object.keys(s.values).map((name) =>
    isMain(name) ? newElement("p", {className: "soft"}, `${name}: see the main values`) : variable(name, s.values, first[name], {slider: false}),
  );
  const head = newElement("div", {className: "when"}, newElement("label", {}, "at ", moment, " s"), remove);
  return newElement("div", {className: "event"}, head, ...rows);
}

// --- a run ---

/** Run again with the next picture. */
function update() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    compute();
  });
}

/** A scenario with the numbers behind the names. */
function resolved(named) {
  const requested = copy(named);
  for (const r of requested.reactions) {
    for (const name of Object.keys(r.add)) if (r.add[name] === "cuts.length") r.add[name] = requested.cuts.length;
  }
  return requested;
}

/** The sliders that a program makes. */
function knob(name, value, low, high, unitName = "") {
  sliders[name] ??= {value: givenSliders[name] ?? value, first: value, low, high, unit: unitName};
  return sliders[name].value;
}

function compiled(requested) {
  if (isForeign) throw new Error("The address has a program, which has not run: read it, then choose Run the program");
  if (program === NO_PROGRAM) return null;
  const act = new Function("knob", "scenario", program)(knob, requested);
  if (typeof act !== "function") throw new Error("the program has to return the function that runs before each step");
  return (t, u, [position, velocity, acceleration]) => act(t, u, {position, velocity, acceleration});
}

/** The run of what is chosen now.
 *
 * Throws: an Error with the reason, if a field holds what is no value, or the program is wrong.
 */
function attempt() {
  const wrong = document.querySelector("#knobs :invalid");
  if (wrong) throw new Error(wrong.validationMessage);
  const requested = resolved(scenario), storage = course && course !== before ? course.storage : null;
  return run(unit, requested, {cycle: compiled(requested), normals: block.normals, storage});
}

function compute() {
  let next = null;
  refusal = "";
  try {
    next = attempt();
    if (next.refused) refusal = `Refused at ${seconds(next.time.at(-1) ?? 0)}: ${next.lines.at(-1)?.text ?? ""}`;
  } catch (error) {
    refusal = error.message;
  } finally {
    showSliders();
  }
  stale = !(next?.count > 1);
  if (!stale) {
    course = next;
    before ??= course;
  }
  showTaken();
  showRefusal();
  show(next?.lines ?? []);
  showBadge(next);
  showExport();
  follow();
}

/** Show which value is refused and why, and that the run on the page is not of the present values. */
function showRefusal() {
  $("problem").textContent = refusal;
  $("stale").hidden = !(stale && course);
  $("trust").hidden = !isForeign;
  document.body.classList.toggle("stale", stale);
  for (const row of document.querySelectorAll(".knob")) {
    const at = refusal.indexOf(`${row.dataset.name} = `), whole = at >= 0 && !/[\w.]/.test(refusal[at - 1] ?? " ");
    row.classList.toggle("refused", whole);
    for (const field of row.querySelectorAll("input, select")) field.setAttribute("aria-invalid", whole);
  }
}

function showSliders() {
  const names = Object.keys(sliders);
  if ($("sliders").dataset.names === names.join()) return;
  $("sliders").dataset.names = names.join();
  const row = (label) => {
    const {first, low, high, unit: unitName} = sliders[label];
    const about = {label, kind: "Real", unit: unitName, min: low, max: high};
    return control(about, sliders[label], "value", {first, usual: high, changed: update});
  };
  $("sliders").replaceChildren(...names.map(row));
}

const changed = () => program !== NO_PROGRAM || JSON.stringify(scenario) !== JSON.stringify(untouched);
const outputs = () => block.variables.filter((v) => v.start === undefined).map((v) => v.name);

/** What the run has cost, and whether its bits are those of the native FMU; null: it could not start. */
async function showBadge(shown) {
  const mine = ++latestBadge, steps = (shown?.count ?? 0) - 1;
  $("cost").textContent = steps > 0 ? `${steps} steps in ${shown.spent.toFixed(1)} ms` : "";
  const badge = (text, kind, title = "") => Object.assign($("badge"), {textContent: text, className: kind, title});
  if (refusal && (changed() || untouched.sha256)) return badge("refused", "bad", refusal);
  if (changed()) return badge(program === NO_PROGRAM ? "changed" : "driven by a program", "changed");
  if (!untouched.sha256) return badge("refused, as by the native FMU", "changed");
  if (!globalThis.crypto?.subtle)
    return badge("bits are compared where the page is a file, or comes by https", "changed");
  const sum = await fingerprint(shown, outputs());
  if (mine !== latestBadge) return undefined;
  const title = `SHA-256 of ${outputs().length} outputs and locals at ${shown.count} points:\n${sum}`;
  return sum === untouched.sha256
    ? badge(`same bits as the native FMU: ${sum.slice(0, 12)}…`, "good", title)
    : badge("NOT the bits of the native FMU", "bad", title);
}

// --- what comes of it ---

/** The last communication point that is not after t. */
const place = (t) => Math.max(bisect(course.time, t + block.runner.close, true) - 1, 0);

/** Show the last run, if there is one; `lines`: what the block has logged of a run that could not start. */
function show(lines) {
  showKey(course?.scenario ?? withMeasuredInputs(scenario, block.variables));
  if (!stale || !course) window.motionsyncMachine.load(course && sceneOf(course, block));
  const none = stale ? "Nothing has run." : "The block has logged nothing.";
  $("log").replaceChildren(...listOf(stale ? lines : messagesOf(course, block), none, point));
  if (!course) {
    $("present").replaceChildren();
    $("all").replaceChildren();
    return;
  }
  if (!stale) plots.show(course, before);
  present(Math.min(now, course.time.at(-1)));
}

/** What the lines of the plots are. */
function showKey({remote, cuts, encoder, axis, start}) {
  const compared = againstPosition(block, cuts), next = compared === "master" ? "" : `; of positions, the ${compared}`;
  const master = !encoder ? "master" : axis.times ? "recorded master" : "true master";
  $("other").textContent = remote ? "telegram" : `${master}${next}`;
  $("smoothed").hidden = !encoder;
  $("taken-master").textContent = `${start[INPUT_MODE] === MEASURED ? "smoothed master," : "master"} as the block takes it`;
}

/** Show another time, which the machine takes over. */
function point(t) {
  const detail = {time: Math.min(Math.max(t, 0), course.time.at(-1)), source: "plots"};
  document.dispatchEvent(new CustomEvent("motionsync:time", {detail}));
}

function present(t) {
  now = t;
  plots.mark(t);
  $("present").replaceChildren(...lamps(course, block, place(t)));
  for (const button of document.querySelectorAll("[data-command]"))
    button.setAttribute("aria-pressed", at(button.dataset.command) !== 0);
  if ($("values").open && performance.now() - listed > REFRESH) list();
}

function textOf(v, x) {
  if (v.kind === "Boolean") return x ? "true" : "false";
  return v.choices.find(([n]) => n === x)?.[1] ?? String(Number(x.toPrecision(9)));
}

function list() {
  if (!course) return;
  listed = performance.now();
  const k = place(now), part = $("filter").value.toLowerCase(), names = block.units[scenario.units];
  const cell = (text, className = "") => newElement("td", {className}, text);
  const value = (v) => `${textOf(v, course.value(v.name, k))} ${names[v.unit]}`;
  const row = (v) => newElement("tr", {}, cell(v.name, "name"), cell(value(v)), cell(v.description));
  $("all").replaceChildren(...block.variables.filter((v) => v.name.toLowerCase().includes(part)).map(row));
}

function zoom(factor) {
  const stop = scenario.stop_time, [low, high] = plots.zoom ?? [0, stop], length = (high - low) * factor;
  const begin = Math.min(Math.max(now - length / 2, 0), Math.max(stop - length, 0));
  plots.stretch(length >= stop ? null : [begin, begin + length]);
}

// --- the run as a file ---

/** Save a text in a file of this name. */
function download(name, text) {
  const link = newElement("a", {download: name, href: URL.createObjectURL(new Blob([text], {type: "text/csv"}))});
  link.click();
  URL.revokeObjectURL(link.href);
}

/** The scenario's file, with what a program has set at its times. */
async function exported() {
  const file = copy(scenario);
  file.settings.push(...copy(course.given));
  file.cuts = copy(course.scenario.cuts);
  const numbers = {...copy(file), reactions: course.scenario.reactions};
  const again = run(unit, numbers, {normals: block.normals}),
    sum = globalThis.crypto?.subtle ? await fingerprint(again, outputs()) : "";
  const comments = [`Explored in the browser, with ${block.name} of motionsync ${block.version}.`];
  if (sum) comments.push(`SHA-256 of all outputs and locals at all ${again.count} communication points: ${sum}`);
  if (program !== NO_PROGRAM && sum !== (await fingerprint(course, outputs())))
    comments.push("What the program did follows in tables [[set]]; the run with them differs in its last digits.");
  return toml(file, block, variables, comments);
}

function write() {
  const open = $("exported").hidden;
  $("exported").hidden = !open;
  $("export").setAttribute("aria-expanded", open);
  showExport();
}

/** The file of the run that is shown; a run that could not start has none. */
async function showExport() {
  if ($("exported").hidden) return;
  const mine = ++latestExport;
  $("download").removeAttribute("href");
  $("written").hidden = stale;
  $("unwritten").hidden = !stale;
  if (stale) return;
  const text = await exported();
  if (mine !== latestExport) return;
  $("toml").value = text;
  $("download").href = `data:text/plain;charset=utf-8,${encodeURIComponent(text)}`;
}

// --- all together ---

function wire() {
  const renew = () => {
    $("unread").textContent = "";
    choose($("scenario").value);
  };
  $("scenario").oninput = $("undo").onclick = renew;
  $("table").onclick = () => download("plots.csv", plots.table());
  $("trust").onclick = () => {
    isForeign = false;
    update();
  };
  $("export").onclick = write;
  $("program").oninput = () => {
    program = $("program").value.trim() ? $("program").value : NO_PROGRAM;
    isForeign = false;
    sliders = {};
    update();
  };
  $("another").onchange = () => {
    plots.renew($("another").value);
    if (course) plots.show(course, before);
  };
  $("closer").onclick = () => zoom(0.5);
  $("wider").onclick = () => zoom(2);
  $("whole").onclick = () => plots.stretch(null);
  $("filter").oninput = $("values").ontoggle = list;
  document.addEventListener("motionsync:time", ({detail}) => course && present(detail.time));
}

async function begin() {
  block = await unpackedJson($("data").textContent);
  variables = new Map(block.variables.map((v) => [v.name, v]));
  unit = await Unit.of(await unpacked($("code").textContent), block.variables, block.runner);
  plots = new Plots($("plots"), block, point);
  const names = block.scenarios.map((s) => newElement("option", {value: s.name, title: s.title}, s.name.replaceAll("_", " ")));
  $("scenario").append(...names, ...(own() ? [newElement("option", {value: PROGRAM}, own().title)] : []));
  $("another").append(...outputs().map((name) => newElement("option", {value: name}, name)));
  $("shaded").hidden = !block.shaded;
  $("shaded").append(block.shaded);
  wire();
  showWhereItIsSet();
  openAddress();
  addEventListener("hashchange", openAddress);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) window.motionsyncMachine.play(true);
  window.motionsyncExplore = {
    run: untouchedRun,
    shown: () => course,
    address,
    fingerprint: (one) => fingerprint(one, outputs()),
    plots: () => plots.drawn.map(({plot}) => plot),
  };
  document.documentElement.dataset.ready = "true";
}

/** Where a page is a part of another one, its own address is not seen: a link leads to it. */
function showWhereItIsSet() {
  $("addressed").hidden = window !== window.top;
  $("framed").hidden = window === window.top;
  const link = $("framed").querySelector("a");
  link.href = location.href;
  link.onclick = () => (link.href = address()); // the page's own may be a moment late
}

/** The run of a scenario as it was, by its name: to compute with it in the browser's console. */
function untouchedRun(name) {
  return run(unit, resolved(block.scenarios.find((s) => s.name === name)), {normals: block.normals});
}

begin().catch((error) => {
  $("problem").textContent = `This browser cannot run the page: ${error.message}`;
});
