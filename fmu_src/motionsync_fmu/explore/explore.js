"use strict";
// The page: what can be changed, and what comes of it. Every change runs the whole scenario anew.

const PROGRAM = "program"; // the choice of the block's own program
const LINES = 100; // of the log, at most
const WORDS = ["", "warning", "discarded", "error"]; // by status
const REFRESH = 120; // ms: the table of all values is slow to draw

/** The block: what the page knows of it, its variables by name, the running unit. */
let block, variables, unit;
/** The scenario as it was, and as it is now; the program in the editor; the sliders that it makes, by name. */
let untouched,
  scenario,
  program = NO_PROGRAM,
  sliders = {};
/** The run, that of the untouched scenario, the plots, the time that is shown. */
let course = null,
  before = null,
  plots,
  now = 0;
let asked = false,
  told = 0,
  listed = 0;

const copy = (thing) => JSON.parse(JSON.stringify(thing));
const own = () =>
  PROGRAMS[block.name] && block.scenarios.some((s) => s.name === PROGRAMS[block.name].scenario)
    ? PROGRAMS[block.name]
    : null;

// --- the choice of a scenario ---

function choose(name) {
  const driven = name === PROGRAM,
    source = block.scenarios.find((s) => s.name === (driven ? own().scenario : name));
  untouched = copy(source);
  if (driven)
    Object.assign(untouched, {
      settings: [],
      reactions: [],
      sha256: "",
      title: `Driven by the program below: ${source.title}`,
    });
  scenario = copy(untouched);
  program = driven ? own().text : NO_PROGRAM;
  sliders = {};
  $("made").replaceChildren();
  $("program").value = program;
  $("editor").open = driven;
  $("title").textContent = scenario.title;
  $("other").textContent = scenario.remote
    ? "telegram"
    : block.roles.PIECES
      ? "master; of positions, the next cut"
      : scenario.cuts.while
        ? "master; of positions, the next mark"
        : "master";
  $("exported").hidden = true;
  $("export").setAttribute("aria-expanded", "false");
  plots.zoom = null;
  plots.renew();
  before = course = null;
  controls();
  compute();
}

// --- what can be changed ---

/** How far a slider of a value 0 goes: the greatest magnitude in this unit. */
function usual(of) {
  const {start, settings, axis} = untouched,
    values = [...Object.entries(start), ...settings.flatMap((s) => Object.entries(s.values))];
  const alike = values.filter(([name]) => variables.get(name).unit === of).map(([, x]) => Math.abs(x));
  const travel = of === "POSITION" || of === "SLAVE_POSITION" ? [span(before?.column("slave.position") ?? [0, 0])] : [];
  return greatest([...alike, ...travel, of === "VELOCITY" ? Math.abs(axis.velocity ?? 0) : 0]) || 100;
}

/** A control of a variable's value. */
function variable(name, values, first, slider = true) {
  const v = variables.get(name),
    unitName = block.units[scenario.units][v.unit];
  return control({...v, unit: unitName}, values, name, {first, usual: slider ? usual(v.unit) : 0, changed: update});
}

/** A control of a number that is no variable of the block. */
function plainNumber(label, description, values, name, first, {of = "NONE", slider = true, ...limits} = {}) {
  const about = {kind: "Real", label, description, unit: block.units[scenario.units][of] ?? of, ...limits};
  return control(about, values, name, {first: first ?? values[name], usual: slider ? usual(of) : 0, changed: update});
}

function controls() {
  const driven = $("scenario").value === PROGRAM; // then the program says where the marks are
  const marks = driven
    ? []
    : Object.entries(scenario.cuts)
        .filter(([name]) => ["length", "offset"].includes(name))
        .map(([name]) =>
          plainNumber(`cuts.${name}`, "of the marks on the material", scenario.cuts, name, untouched.cuts[name], {
            of: "POSITION",
          }),
        );
  const starts = Object.keys(scenario.start).map((name) => variable(name, scenario.start, untouched.start[name]));
  const runs = [
    ["stop_time", "the end of the run"],
    ["step_size", "the step size, and the cycle of the reactions"],
  ].map(([name, text]) => plainNumber(name, text, scenario, name, untouched[name], {of: "s", slider: false}));
  $("groups").replaceChildren(
    ...group("Marks", marks),
    ...group(scenario.remote ? "The remote axis" : "The master", axisRows()),
    ...group("Start values", [...starts, another("Another one", startable(), addStart)]),
    ...commandGroup(),
    ...group("Reactions", scenario.reactions.map(reactionRow), false),
    ...group("The run", runs, false),
  );
}

const startable = () =>
  block.variables.filter(
    (v) =>
      (v.start !== undefined &&
        !(v.name in scenario.start) &&
        !v.name.startsWith(`${scenario.remote?.part ?? "master"}.`)) ||
      v.name === "master.period",
  );

function addStart(name) {
  scenario.start[name] = untouched.start[name] = variables.get(name).start; // it changes nothing
  controls();
}

/** A choice of a further variable. */
function another(label, choices, act) {
  const options = [
    made("option", {value: ""}, "…"),
    ...choices.map((v) => made("option", {value: v.name, title: v.description}, v.name)),
  ];
  const select = made("select", {"aria-label": label}, ...options);
  select.onchange = () => select.value && act(select.value);
  return made("div", {className: "knob"}, made("span", {className: "soft"}, label), select);
}

function axisRows() {
  const {axis, remote, drive} = scenario,
    first = untouched.axis,
    rows = [];
  const of = {position: "POSITION", velocity: "VELOCITY", acceleration: "ACCELERATION", jerk: "JERK", duration: "s"};
  for (const name of ["position", "velocity"]) {
    axis[name] ??= 0;
    first[name] ??= 0;
    rows.push(plainNumber(name, "at the beginning", axis, name, first[name], {of: of[name]}));
  }
  const segments = (axis.segments ?? []).flatMap((segment, i) =>
    Object.keys(segment).map((name) => {
      const limits = name === "duration" ? {min: 0} : {};
      return plainNumber(`${i + 1}: ${name}`, `of segment ${i + 1}`, segment, name, first.segments[i][name], {
        of: of[name],
        ...limits,
      });
    }),
  );
  rows.push(...group("Segments", segments, segments.length < 4));
  if (drive)
    rows.push(made("p", {className: "soft"}, `It follows ${drive.follows}, with a lag of ${drive.time_constant} s.`));
  if (!remote) return rows;
  remote.rates.forEach((rate, i) =>
    rows.push(
      plainNumber(
        `sender's cycle${i ? ` from ${rate.at} s on` : ""}`,
        "",
        rate,
        "cycle",
        untouched.remote.rates[i].cycle,
        {of: "s", ...near(untouched.remote.rates[i].cycle)},
      ),
    ),
  );
  rows.push(
    plainNumber(
      "phase",
      "how long before 0 the first telegram is sent, as a share of the sender's cycle",
      remote,
      "phase",
      untouched.remote.phase,
      {min: 0, max: 0.99},
    ),
  );
  if (block.normals[remote.seed])
    rows.push(
      plainNumber(
        "jitter",
        "of sending and receiving, one sigma as a share of the receiver's cycle",
        remote,
        "jitter",
        untouched.remote.jitter,
        {min: 0, max: 0.15},
      ),
    );
  return rows;
}

/** Two clocks that are meant to be alike differ by little. */
const near = (cycle) => ({min: 0.99 * cycle, max: 1.01 * cycle});

function reactionRow(r, i) {
  const first = untouched.reactions[i] ?? r,
    when = made("div", {className: "when"}, `when ${r.name} ${r.comparison}`);
  const v = variables.get(r.name),
    discrete = v.kind === "Boolean" || v.choices.length > 0,
    rows = [];
  if (discrete) when.textContent = `when ${r.when}`;
  else rows.push(plainNumber("value", "", r, "value", first.value, {of: v.unit, slider: false}));
  when.append(
    made("span", {className: "soft"}, r.times === null ? "each time" : r.times === 1 ? "once" : `${r.times} times`),
  );
  rows.push(
    plainNumber("after", "how long after the scan that sees it", r, "after", first.after, {of: "s", slider: false}),
  );
  for (const name of Object.keys(r.set)) rows.push(variable(name, r.set, first.set[name], false));
  for (const [name, more] of Object.entries(r.add)) {
    if (more === "cuts.length") rows.push(made("p", {className: "soft"}, `${name}: cuts.length more`));
    else
      rows.push(
        plainNumber(`${name}: more by`, "", r.add, name, first.add[name], {
          of: variables.get(name).unit,
          slider: false,
        }),
      );
  }
  return made("div", {className: "event"}, when, ...rows);
}

// --- commands ---

function commandGroup() {
  const commands = block.variables
    .filter((v) => v.command)
    .map((v) => {
      const button = made("button", {type: "button", title: v.description, "aria-pressed": "false"}, v.name);
      button.onclick = () => give(v.name, at(v.name) ? 0 : 1);
      button.dataset.command = v.name;
      return button;
    });
  const others = block.variables.filter(
    (v) => v.start !== undefined && !v.command && v.variability !== "fixed" && !scripted(v.name),
  );
  const rows = [...scenario.settings].sort((a, b) => a.at - b.at).map(settingRow);
  const head = commands.length
    ? [made("p", {className: "soft"}, "At the time that is shown:"), made("div", {className: "commands"}, ...commands)]
    : [];
  return group("Commands", [...head, another("Set at this time", others, (name) => give(name, at(name))), ...rows]);
}

/** Whether an input comes from the script of the axis. */
function scripted(name) {
  const {remote} = scenario;
  if (remote) return name.startsWith(`${remote.part}.`) || name === remote.cycle_index;
  return ["master.position", "master.velocity", "master.acceleration"].includes(name);
}

/** A value as the step has it that begins at the time shown. */
function at(name) {
  return course?.count ? course.value(name, Math.min(place(now) + 1, course.count - 1)) : variables.get(name).start;
}

/** One more setting, at the communication point that is shown; the past stays as it is. */
function give(name, value) {
  const t = course.time[Math.min(Math.max(place(now), 1), course.count - 2)];
  let setting = scenario.settings.find((s) => s.at === t);
  if (!setting) scenario.settings.push((setting = {at: t, values: {}}));
  setting.values[name] = value;
  controls();
  update();
}

function settingRow(s) {
  const first = untouched.settings.find((other) => other.at === s.at)?.values ?? {};
  const moment = made("input", {type: "number", step: "any", value: s.at, "aria-label": "time of the setting, in s"});
  moment.onchange = () => {
    const t = Number(moment.value);
    if (t > 0 && t < scenario.stop_time) s.at = t;
    controls();
    update();
  };
  const remove = made("button", {type: "button"}, "Remove");
  remove.onclick = () => {
    scenario.settings.splice(scenario.settings.indexOf(s), 1);
    controls();
    update();
  };
  const rows = Object.keys(s.values).map((name) => variable(name, s.values, first[name], false));
  return made(
    "div",
    {className: "event"},
    made("div", {className: "when"}, made("label", {}, "at ", moment, " s"), remove),
    ...rows,
  );
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
  const wanted = copy(named);
  for (const r of wanted.reactions) {
    for (const name of Object.keys(r.add)) if (r.add[name] === "cuts.length") r.add[name] = wanted.cuts.length;
  }
  return wanted;
}

/** The sliders that a program makes. */
function knob(name, value, low, high, unitName = "") {
  sliders[name] ??= {value, first: value, low, high, unit: unitName};
  return sliders[name].value;
}

function compiled(wanted) {
  if (program === NO_PROGRAM) return null;
  const act = new Function("knob", "scenario", program)(knob, wanted);
  if (typeof act !== "function") throw new Error("the program has to return the function that runs before each step");
  return (t, u, [position, velocity, acceleration]) => act(t, u, {position, velocity, acceleration});
}

function compute() {
  $("problem").textContent = "";
  const wanted = resolved(scenario),
    room = course && course !== before ? course.rows : null;
  try {
    course = run(unit, wanted, {cycle: compiled(wanted), normals: block.normals, room});
  } catch (error) {
    $("problem").textContent = error.message;
    return;
  } finally {
    showSliders();
  }
  before ??= course;
  if (course.refused)
    $("problem").textContent = `Refused at ${time(course.time.at(-1) ?? 0)}: ${course.lines.at(-1)?.text ?? ""}`;
  if (course.count > 1) show();
  tell();
}

function showSliders() {
  const names = Object.keys(sliders);
  if ($("made").dataset.names === names.join()) return;
  $("made").dataset.names = names.join();
  $("made").replaceChildren(
    ...names.map((name) => {
      const {first, low, high, unit: unitName} = sliders[name];
      return control({label: name, kind: "Real", unit: unitName, min: low, max: high}, sliders[name], "value", {
        first,
        usual: high,
        changed: update,
      });
    }),
  );
}

const changed = () => program !== NO_PROGRAM || JSON.stringify(scenario) !== JSON.stringify(untouched);
const outputs = () => block.variables.filter((v) => v.start === undefined).map((v) => v.name);

/** What the run has cost, and whether its bits are those of the native FMU. */
async function tell() {
  const mine = ++told,
    shown = course;
  $("cost").textContent = `${shown.count - 1} steps in ${shown.spent.toFixed(1)} ms`;
  const badge = (text, kind, title = "") => Object.assign($("badge"), {textContent: text, className: kind, title});
  if (changed()) return badge(program === NO_PROGRAM ? "changed" : "driven by a program", "changed");
  if (!untouched.sha256) return badge("refused, as by the native FMU", "changed");
  if (!globalThis.crypto?.subtle)
    return badge("bits are compared where the page is a file, or comes by https", "changed");
  const found = await fingerprint(shown, outputs());
  if (mine !== told) return undefined;
  const title = `SHA-256 of ${outputs().length} outputs and locals at ${shown.count} points:\n${found}`;
  return found === untouched.sha256
    ? badge(`same bits as the native FMU: ${found.slice(0, 12)}…`, "good", title)
    : badge("NOT the bits of the native FMU", "bad", title);
}

// --- what comes of it ---

const time = (t) => `${t.toFixed(3)} s`;

/** The last communication point that is not after t. */
const place = (t) => Math.max(bisect(course.time, t + CLOSE, true) - 1, 0);

function show() {
  window.motionsyncMachine.load(sceneOf(course, block));
  plots.show(course, before);
  $("log").replaceChildren(
    ...(course.lines.length
      ? course.lines.slice(0, LINES).map(logLine)
      : [made("p", {className: "soft"}, "The block has nothing to say.")]),
  );
  present(Math.min(now, course.time.at(-1)));
}

function logLine({t, status, text}) {
  const line = made(
    "button",
    {type: "button", className: status > 1 ? "bad" : ""},
    `${time(t)}  ${WORDS[status]}: ${text}`,
  );
  line.onclick = () => point(t);
  return line;
}

/** Show another time, and tell the machine. */
function point(t) {
  document.dispatchEvent(
    new CustomEvent("motionsync:time", {detail: {time: Math.min(Math.max(t, 0), course.time.at(-1)), source: "plots"}}),
  );
}

function present(t) {
  now = t;
  plots.mark(t);
  const k = place(t),
    flags = block.variables.filter((v) => v.start === undefined && v.kind === "Boolean" && !v.name.includes("."));
  $("present").replaceChildren(
    ...flags.map((v) =>
      made(
        "span",
        course.value(v.name, k) ? {title: v.description} : {title: v.description, className: "off"},
        course.value(v.name, k) ? made("b", {}, v.name) : v.name,
      ),
    ),
  );
  for (const button of document.querySelectorAll("[data-command]"))
    button.setAttribute("aria-pressed", at(button.dataset.command) !== 0);
  if ($("values").open && performance.now() - listed > REFRESH) list();
}

const textOf = (v, x) =>
  v.kind === "Boolean"
    ? x
      ? "true"
      : "false"
    : (v.choices.find(([n]) => n === x)?.[1] ?? String(Number(x.toPrecision(9))));

function list() {
  listed = performance.now();
  const k = place(now),
    part = $("filter").value.toLowerCase(),
    names = block.units[scenario.units];
  const row = (v) =>
    made(
      "tr",
      {},
      made("td", {className: "name"}, v.name),
      made("td", {}, `${textOf(v, course.value(v.name, k))} ${names[v.unit]}`),
      made("td", {}, v.description),
    );
  $("all").replaceChildren(...block.variables.filter((v) => v.name.toLowerCase().includes(part)).map(row));
}

function zoom(factor) {
  const stop = scenario.stop_time,
    [low, high] = plots.zoom ?? [0, stop],
    length = (high - low) * factor;
  const begin = Math.min(Math.max(now - length / 2, 0), Math.max(stop - length, 0));
  plots.stretch(length >= stop ? null : [begin, begin + length]);
}

// --- the run as a file ---

/** The scenario's file; what a program has set stands in it at its times. */
async function exported() {
  const file = copy(scenario);
  file.settings.push(...copy(course.given));
  file.cuts = copy(course.scenario.cuts);
  const numbers = {...copy(file), reactions: course.scenario.reactions};
  const again = run(unit, numbers, {normals: block.normals}),
    sum = globalThis.crypto?.subtle ? await fingerprint(again, outputs()) : "";
  const remarks = [`Explored in the browser, with ${block.name} of motionsync ${block.version}.`];
  if (sum) remarks.push(`SHA-256 of all outputs and locals at all ${again.count} communication points: ${sum}`);
  if (program !== NO_PROGRAM && sum !== (await fingerprint(course, outputs())))
    remarks.push("What the program did follows in tables [[set]]; the run with them differs in its last digits.");
  return toml(file, block.name, variables, remarks);
}

async function write() {
  const open = $("exported").hidden;
  $("exported").hidden = !open;
  $("export").setAttribute("aria-expanded", open);
  if (!open) return;
  const text = await exported();
  $("toml").value = text;
  $("download").href = `data:text/plain;charset=utf-8,${encodeURIComponent(text)}`;
}

// --- all together ---

/** A part of the page that is packed: base64 of raw deflate. */
async function unpacked(id) {
  const bytes = Uint8Array.from(atob($(id).textContent), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
}

function wire() {
  $("scenario").oninput = () => choose($("scenario").value);
  $("undo").onclick = () => choose($("scenario").value);
  $("export").onclick = write;
  $("program").oninput = () => {
    program = $("program").value.trim() ? $("program").value : NO_PROGRAM;
    sliders = {};
    update();
  };
  $("another").onchange = () => {
    plots.renew($("another").value);
    plots.show(course, before);
  };
  $("closer").onclick = () => zoom(0.5);
  $("wider").onclick = () => zoom(2);
  $("whole").onclick = () => plots.stretch(null);
  $("filter").oninput = $("values").ontoggle = list;
  document.addEventListener("motionsync:time", ({detail}) => present(detail.time));
}

async function begin() {
  block = JSON.parse(new TextDecoder().decode(await unpacked("data")));
  variables = new Map(block.variables.map((v) => [v.name, v]));
  unit = await Unit.of(await unpacked("code"), block.variables);
  plots = new Plots($("plots"), block, point);
  const names = block.scenarios.map((s) =>
    made("option", {value: s.name, title: s.title}, s.name.replaceAll("_", " ")),
  );
  $("scenario").append(...names, ...(own() ? [made("option", {value: PROGRAM}, own().title)] : []));
  $("another").append(
    ...block.variables.filter((v) => v.start === undefined).map((v) => made("option", {value: v.name}, v.name)),
  );
  $("shaded").hidden = !block.shaded;
  $("shaded").append(block.shaded);
  wire();
  const wanted = new URLSearchParams(location.hash.slice(1)).get("run");
  if ([...$("scenario").options].some((option) => option.value === wanted)) $("scenario").value = wanted;
  choose($("scenario").value);
  window.motionsyncExplore = {
    run: untouchedRun,
    fingerprint: (one) => fingerprint(one, outputs()),
    scene: (one) => sceneOf(one, block),
  };
  document.documentElement.dataset.ready = "true";
}

/** The run of a scenario as it was, by its name: for whoever wants to compute with it in the browser's console. */
function untouchedRun(name) {
  return run(unit, resolved(block.scenarios.find((s) => s.name === name)), {normals: block.normals});
}

begin().catch((error) => {
  $("problem").textContent = `This browser cannot run the page: ${error.message}`;
});
