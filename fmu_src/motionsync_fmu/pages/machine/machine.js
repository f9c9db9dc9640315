"use strict";
// The animated picture of a run's machine, from data that machine_data.js makes: of the recording that is next to this script,
// or on the page, which gives them to `load`. A scene below draws them at a time.
// `window.motionsyncMachine.show(t)` stops the machine and shows it at t, in s; `play(true)` lets it go.
(() => {
const root = document.currentScript.closest(".motionsync-machine");
const given = root.querySelector("script[type='application/octet-stream']");
const svg = root.querySelector("svg");
const [button, slider, clock, speed] =
  ["button", "input", "output", "select"].map((name) => root.querySelector(`.controls ${name}`));
const calm = matchMedia("(prefers-reduced-motion: reduce)"); // a few pictures a second for those who prefer less motion

let data, scene; // what is drawn, and what draws it
const scenes = {}; // by name: each makes a scene of the present data

// --- signals ---

const CLOSE = 1e-9; // s: a time that is so little after t counts as t

/** The place of the last entry of `times` that is not after t; the first one if all are. */
function last(times, t) {
  let low = 0, high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t + CLOSE) low = middle; else high = middle;
  }
  return low;
}

/** The value of a held signal at t. */
const held = (signal, t) => signal.x[last(signal.t, t)];

/** Position and velocity of a smooth signal at t: the cubic between two knots, with their values and slopes. */
function smooth(signal, t) {
  const i = Math.min(last(signal.t, t), signal.t.length - 2), h = signal.t[i + 1] - signal.t[i];
  if (!(h > 0)) return [signal.x[i + 1], signal.v[i + 1]];
  const u = (t - signal.t[i]) / h, w = 1 - u;
  const [x0, x1, s0, s1] = [signal.x[i], signal.x[i + 1], h * signal.v[i], h * signal.v[i + 1]];
  return [
    w * w * ((1 + 2 * u) * x0 + u * s0) + u * u * ((1 + 2 * w) * x1 - w * s1),
    (6 * u * w * (x1 - x0) + w * (1 - 3 * u) * s0 + u * (1 - 3 * w) * s1) / h,
  ];
}

// --- drawing ---

/** A new SVG element in a parent. */
function draw(parent, name, attributes = {}) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  parent.appendChild(element);
  return set(element, attributes);
}

function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "text") element.textContent = value;
    else element.setAttribute(name, typeof value === "number" ? +value.toFixed(3) : value);
  }
  return element;
}

/** Elements that come and go: `use(i, attributes)` shows the i-th, `end(count)` hides those after the first `count`. */
function pool(parent, name, attributes = {}) {
  const elements = [];
  return {
    use(i, values) {
      while (elements.length <= i) elements.push(draw(parent, name, attributes));
      return set(elements[i], {visibility: "visible", ...values});
    },
    end(count) {
      for (const element of elements.slice(count)) element.setAttribute("visibility", "hidden");
    },
  };
}

/** A number with its `unit`, with as many digits as the picture is exact, without a negative zero. */
function number(value, unit, fineness = data.within) {
  const decimals = Math.min(Math.max(-Math.floor(Math.log10(fineness) + 1e-9) - 1, 0), 6);
  const text = value.toFixed(decimals);
  return (/^-0\.?0*$/.test(text) ? text.slice(1) : text).replace("-", "\u2212") + (unit ? ` ${unit}` : "");
}

/** The velocity of a line; where its unit is a length, in m/min, too. */
function lineSpeed(velocity, fineness) {
  const factor = {mm: 0.06, m: 60}[data.unit], text = number(velocity, `${data.unit}/s`, fineness);
  return factor ? `${text} (${number(factor * velocity, "", factor * fineness)}\u00a0m/min)` : text;
}

/** Round distances for ticks: about one each `pixels` px. */
function tick(span, width, pixels) {
  const least = span * pixels / width, power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least);
}

/** A ruler with ticks and numbers, from low to high, `at` giving the place in px; each call draws it anew. */
function ruler(parent, y, [low, high], at, unit) {
  parent.replaceChildren();
  const distance = tick(high - low, Math.abs(at(high) - at(low)), 70);
  const decimals = Math.max(0, -Math.floor(Math.log10(distance) + 1e-9));
  draw(parent, "line", {x1: at(low), x2: at(high), y1: y, y2: y, stroke: "var(--muted)"});
  for (let n = Math.ceil(low / distance); n * distance <= high; n++) {
    const x = at(n * distance);
    draw(parent, "line", {x1: x, x2: x, y1: y, y2: y + 5, stroke: "var(--muted)"});
    const text = (n * distance).toFixed(decimals).replace("-", "\u2212");
    draw(parent, "text", {x, y: y + 18, class: "soft", "text-anchor": "middle", text});
  }
  draw(parent, "text", {x: at(high) + 5, y: y + 4, class: "soft", text: unit});
}

/** An arrow of a velocity: a shaft with a head, from (x, y) by `length` px to the right. */
function arrow(x, y, length) {
  const size = Math.sign(length) * Math.min(7, Math.abs(length));
  const end = x + length, neck = end - size;
  return Math.abs(length) < 1 ? "" : `M${x} ${y}H${neck}M${neck} ${y - 4}L${end} ${y}L${neck} ${y + 4}Z`;
}

/** Write below the picture what its colours and lines mean: of each the text, its colour, and "line" or "dashes". */
function showLegend(rows) {
  const parts = rows.map(([text, colour, form = "body"]) => {
    const part = document.createElement("span"), sample = document.createElement("i");
    sample.className = form;
    sample.style.setProperty("--colour", `var(${colour})`);
    part.append(sample, text);
    return part;
  });
  root.querySelector(".legend").replaceChildren(...parts);
}

const readouts = new Map(); // by name: the element, and the length of its longest text

/** Show a value under its name; it gets as many lines as its longest value, so that the picture below stays in place. */
function showReadout(name, value, title = "") {
  if (!readouts.has(name)) {
    const row = document.createElement("div"), dt = document.createElement("dt"), dd = document.createElement("dd");
    if (name === "state") row.className = "wide";
    dt.textContent = name;
    row.append(dt, dd);
    root.querySelector(".readouts").append(row);
    readouts.set(name, {shown: dd, longest: 0});
  }
  const readout = readouts.get(name), {shown} = readout;
  shown.textContent = value;
  shown.title = title;
  if (value.length <= readout.longest) return;
  readout.longest = value.length;
  shown.style.minHeight = `${Math.ceil(shown.getBoundingClientRect().height)}px`;
}

/** Show the state: its name, and what it means. */
function showState(t) {
  nameState(held(data.state, t));
}

function nameState(number) {
  const [name, meaning] = data.states[number] ?? ["", ""];
  root.dataset.state = name;
  showReadout("state", `${name} \u2013 ${meaning}`, meaning);
}

// --- pieces of material ---

const GAP = 14, FASTER = 0.15; // px between pieces: those that are cut off run so much faster until the gap is there

/** By how many px the piece at a place on the material has been taken away from the material that is not cut yet.
 * `length` makes px of the material's travel. */
function taken(place, master, done, {flow, length}) {
  let sum = 0;
  for (const cut of done) {
    if (flow * data.ratio * (cut.place - place) > 1e-9 * data.span) {
      sum += Math.min(GAP, FASTER * Math.abs(length(data.ratio * (master - cut.master))));
    }
  }
  return flow * sum;
}

/** The material that is not cut yet, and the pieces that have been cut off: their ends, null where one is endless, and
 * their names. */
function partedMaterial(done) {
  const ready = data.pieces.slice(0, done.length), front = data.pieces[done.length]?.begin ?? ready.at(-1)?.end ?? null;
  const off = ready.map(({number: n, begin, end, kind, name, length: of}) => {
    const text = `${n}: ${name === "PRODUCT" ? "" : `${name} `}${number(of, data.unit, 1e-4 * data.span)}`;
    return {upstream: end, downstream: begin, text, fill: `var(--kind-${kind})`};
  });
  return [{upstream: null, downstream: front, text: "", fill: "var(--wood)"}, ...off.reverse()];
}

/** The rows of the legend for material of which pieces are cut off. */
function materialLegend() {
  const kinds = new Map(data.pieces.map(({kind, name}) => [kind, name]));
  const text = (name) => name.toLowerCase().replaceAll("_", " ");
  return [["material", "--wood"], ...[...kinds].map(([kind, name]) => [text(name), `--kind-${kind}`])];
}

/** Show how many pieces have been cut off, and what the last one is. */
function showPieces(done) {
  showReadout("pieces", `${done.length} of ${data.pieces.length}`);
  const last = data.pieces[done.length - 1];
  showReadout("last piece", last ? `${number(last.length, data.unit, 1e-3)} ${last.name}` : "none");
}

/* fragment.py puts the scenes here */

/** Fit the picture and its readouts to the width of the page. */
function fit() {
  for (const readout of readouts.values()) {
    readout.longest = 0;
    readout.shown.style.minHeight = "";
  }
  new Set(data.state.x).forEach(nameState);
  scene.resize(svg.clientWidth);
}

// --- time ---

let now = 0, playing = false, before = 0, waited = 0;

/** Draw another run from now on, at the time that is shown; null: no machine. */
function load(run) {
  data = run;
  root.hidden = !run;
  if (!run) {
    play(false);
    return;
  }
  svg.replaceChildren();
  readouts.clear();
  root.querySelector(".readouts").replaceChildren();
  slider.max = data.stop;
  scene = scenes[data.scene]();
  showLegend(scene.legend);
  fit();
  show(now, "beginning");
}

/** Show the machine at t, and notify the rest of the page, unless the time comes from there. */
function show(t, source = "machine") {
  now = Math.min(Math.max(t, 0), data.stop);
  slider.value = now;
  clock.textContent = `${now.toFixed(3)} s`;
  slider.setAttribute("aria-valuetext", clock.textContent);
  root.dataset.time = now;
  showState(now);
  scene.show(now);
  if (source === "machine") {
    document.dispatchEvent(new CustomEvent("motionsync:time", {detail: {time: now, source}}));
  }
}

function play(on) {
  if (on && now >= data.stop) show(0);
  playing = on;
  before = waited = 0;
  button.textContent = on ? "\u275A\u275A" : "\u25B6";
  button.setAttribute("aria-label", on ? "Pause" : "Play");
  root.dataset.playing = on;
  if (on) requestAnimationFrame(step);
}

/** One picture of the motion; `stamp`: the browser's time, in ms. */
function step(stamp) {
  if (!playing) return;
  if (before) waited += Math.min(stamp - before, 100);
  before = stamp;
  if (waited >= (calm.matches ? 250 : 1)) {
    show(now + waited / 1000 * Number(speed.value));
    waited = 0;
  }
  if (now >= data.stop) play(false);
  else requestAnimationFrame(step);
}

function key(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target === speed) return;
  const stride = (event.shiftKey ? 10 : 1) * 0.02 * Number(speed.value);
  const places = {ArrowLeft: now - stride, ArrowRight: now + stride, Home: 0, End: data.stop};
  if (event.key === " ") {
    play(!playing);
  } else if (event.key in places) {
    play(false);
    show(places[event.key]);
  } else {
    return;
  }
  event.preventDefault();
}

button.addEventListener("click", () => play(!playing));
button.addEventListener("keyup", (event) => event.key === " " && event.preventDefault()); // the key has done it
slider.addEventListener("input", () => {
  play(false);
  show(Number(slider.value));
});
root.addEventListener("keydown", key);
document.addEventListener("motionsync:time", ({detail}) => {
  if (!data || detail.source === "machine") return;
  play(false);
  show(detail.time, detail.source);
});
new ResizeObserver(() => {
  if (!data) return;
  fit();
  showState(now);
  scene.show(now);
}).observe(svg);
window.motionsyncMachine = {
  load,
  show(t) {
    if (!data) return;
    play(false);
    show(t);
  },
  play: (on) => data && play(on),
  drawn: () => data,
};
})();
