// The scene of an axis on another controller. A magnified window moves with the
// true axis; in it are the axis of the telegram, and that of the block. Below is what has just been.
scenes.window = () => {
const HEIGHT = 252, EDGE = 34, RULER = 92, PAST_TOP = 150, PAST_BOTTOM = 238; // px
const PAST = 1; // s, as much as is drawn of the past
const MOST = 400; // points of the past
let width = 600;
const at = (error) => width / 2 + Math.max(-1, Math.min(1, error / data.half)) * (width / 2 - EDGE);

const scale = draw(svg, "g"), past = draw(svg, "g"), markers = draw(svg, "g");
const ticks = pool(scale, "line", {stroke: "var(--grid)"});
const frame = draw(scale, "rect", {fill: "none", stroke: "var(--grid)"});
const truth = draw(scale, "line", {y1: 24, y2: PAST_BOTTOM, stroke: "var(--ink)", "stroke-dasharray": "2 3"});
const zero = draw(scale, "text", {y: 16, "text-anchor": "middle", text: "true axis"});
const rulerLayer = draw(scale, "g");
const title = draw(scale, "text", {y: PAST_TOP - 8, class: "soft", text: `the last ${PAST} s`});
const traces = {telegram: trace("var(--master)", 1), corrected: trace("var(--slave)", 2)};
const telegram = marker("telegram", "var(--master)", 36), corrected = marker("slave", "var(--slave)", 62);
svg.setAttribute("height", HEIGHT);

function trace(stroke, thick) {
  return draw(past, "path", {fill: "none", stroke, "stroke-width": thick, "stroke-linejoin": "round"});
}

function marker(name, fill, y) {
  const layer = draw(markers, "g", {class: name});
  draw(layer, "rect", {x: -34, y: y - 11, width: 68, height: 18, rx: 4, fill});
  draw(layer, "path", {d: `M0 ${y + 7}V${RULER}`, stroke: fill, "stroke-width": 2});
  draw(layer, "path", {d: `M-5 ${RULER - 9}L0 ${RULER}L5 ${RULER - 9}Z`, fill});
  draw(layer, "text", {y: y + 3, class: "plate", text: name});
  return layer;
}

function resize(pixels) {
  width = Math.max(pixels, 300);
  ruler(rulerLayer, RULER, [-data.half, data.half], at, data.unit);
  set(frame, {x: EDGE, width: width - 2 * EDGE, y: PAST_TOP, height: PAST_BOTTOM - PAST_TOP});
  set(truth, {x1: width / 2, x2: width / 2});
  set(zero, {x: width / 2});
  set(title, {x: EDGE});
}

/** What an error has been in the last second: the newest at the top, as it comes down from the marker. */
function pastOf(signal, t) {
  const final = last(signal.t, t), first = last(signal.t, Math.max(t - PAST, 0)), stride = Math.ceil((final - first + 1) / MOST);
  const y = (time) => PAST_TOP + Math.min(Math.max((t - time) / PAST, 0), 1) * (PAST_BOTTOM - PAST_TOP);
  let d = `M${at(signal.x[final]).toFixed(1)} ${y(t).toFixed(1)}`;
  for (let i = final; i >= first; i -= stride) {
    d += `L${at(signal.x[i]).toFixed(1)} ${y(signal.t[i]).toFixed(1)}`;
  }
  return d;
}

function show(t) {
  const [position, velocity] = smooth(data.true, t);
  const errors = {telegram: held(data.telegram, t), corrected: held(data.corrected, t)};
  for (const [name, layer] of [["telegram", telegram], ["corrected", corrected]]) {
    set(layer, {transform: `translate(${at(errors[name]).toFixed(3)} 0)`});
    set(traces[name], {d: pastOf(data[name], t)});
  }
  const slave = held(data.slave, t);
  Object.assign(corrected.dataset, {slavePosition: slave, error: errors.corrected, x: at(errors.corrected)});
  Object.assign(telegram.dataset, {error: errors.telegram, x: at(errors.telegram)});
  const fine = data.half * 1e-3;
  showReadout("true axis", number(position, data.unit, fine));
  showReadout("velocity", number(velocity, `${data.unit}/s`, fine));
  showReadout("telegram is off by", number(errors.telegram, data.unit, fine));
  showReadout("slave is off by", number(errors.corrected, data.unit, fine));
  showReadout("index off, telegram", number(held(data.telegram_index, t), "cycles", 1e-3));
  showReadout("index off, slave", number(held(data.corrected_index, t), "cycles", 1e-3));
}

const legend = [
  ["axis of the telegram", "--master"],
  ["slave", "--slave"],
  ["true axis", "--ink", "dashes"],
];

return {resize, show, legend};
};
