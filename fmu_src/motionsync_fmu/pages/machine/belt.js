// The scene of a carriage over moving material. What is on the material at m passes
// the carriage's position ratio (master - m).
scenes.belt = () => {
const SAW = data.tool === "saw";
const HEIGHT = 240, EDGE = 32; // px, as all that follows
const RAIL = 52, TOP = 128, BOTTOM = 160, ROLLERS = 172, LINE = 192, RULER = 212;
const GRAIN = 46; // between the lines by which one sees the material move
const LOWERING = 0.06; // s, the tool needs it up and down
const [low, high] = data.window, ratio = data.ratio;
const travel = ratio * (smooth(data.master, data.stop)[0] - smooth(data.master, 0)[0]);
const flow = Math.sign(travel) || 1;
const cuts = data.cuts.map((cut) => ({...cut, master: smooth(data.master, cut.end)[0]}));
let width = 600;

const at = (position) => EDGE + (position - low) / (high - low) * (width - 2 * EDGE);
const length = (distance) => distance / (high - low) * (width - 2 * EDGE);

// --- what is at rest, and the parts that move ---

const [ground, rollers, stock, rail, measures, carriage] =
  ["ground", "rollers", "stock", "rail", "measures", "carriage"].map((name) => draw(svg, "g", {class: name}));
const fixed = draw(ground, "g"), scale = draw(ground, "g");
const spokes = pool(rollers, "path", {fill: "var(--paper)", stroke: "var(--muted)"});
const pieces = pool(stock, "rect", {stroke: "var(--edge)", rx: SAW ? 1 : 0});
const grain = pool(stock, "path", {stroke: "var(--grain)", "stroke-width": 1.5, "stroke-linecap": "round"});
const names = pool(stock, "text", {"text-anchor": "middle", class: data.pieces ? "" : "soft"});
const marks = pool(stock, "path", SAW
  ? {stroke: "var(--ink)", "stroke-width": 1.5, "stroke-dasharray": "4 3", fill: "none"}
  : {stroke: "var(--edge)", fill: "var(--wood)"});
const flags = pool(stock, "text", {"text-anchor": "middle"});
const kerf = draw(stock, "line", {y1: TOP, stroke: "var(--paper)", "stroke-width": 3});
const lineArrow = draw(ground, "path", {stroke: "var(--master)", fill: "var(--master)", "stroke-width": 2});
const dimension = draw(measures, "path", {stroke: "var(--muted)", fill: "none"});
const distance = draw(measures, "text", {y: 96, "text-anchor": "middle", class: "soft"});

draw(carriage, "path", {d: `M0 ${TOP}V${RULER}`, stroke: "var(--slave)", "stroke-dasharray": "1 3"});
const tool = draw(carriage, "g", {class: "tool"});
if (SAW) {
  draw(tool, "rect", {x: -5, y: RAIL - 34, width: 10, height: 76, fill: "var(--steel)", stroke: "var(--muted)"});
  const teeth = `M-1.5 ${RAIL + 42}V${TOP - 18}L0 ${TOP - 11}L1.5 ${TOP - 18}V${RAIL + 42}Z`;
  draw(tool, "path", {d: teeth, fill: "var(--ink)", stroke: "var(--ink)"});
} else {
  draw(tool, "rect", {x: -4, y: RAIL - 30, width: 8, height: 64, fill: "var(--steel)", stroke: "var(--muted)"});
  const jaws = `M-15 ${TOP - 22}V${RAIL + 34}H15V${TOP - 22}`;
  draw(tool, "path", {d: jaws, fill: "none", stroke: "var(--ink)", "stroke-width": 3});
}
draw(carriage, "rect", {x: -27, y: RAIL - 16, width: 54, height: 30, rx: 5, fill: "var(--slave)"});
for (const x of [-16, 16]) {
  draw(carriage, "circle", {cx: x, cy: RAIL - 17, r: 5, fill: "var(--steel)", stroke: "var(--muted)"});
}
draw(carriage, "path", {d: `M-5 ${RULER + 8}L0 ${RULER}L5 ${RULER + 8}Z`, fill: "var(--slave)"});
const slaveArrow = draw(carriage, "path", {stroke: "var(--slave)", fill: "var(--slave)", "stroke-width": 2});
svg.setAttribute("height", HEIGHT);

/** Draw anew what depends on the width alone. */
function resize(pixels) {
  width = Math.max(pixels, 200);
  fixed.replaceChildren();
  rail.replaceChildren();
  const home = at(data.home.at), line = {stroke: "var(--muted)", "stroke-dasharray": "3 4"};
  const labels = [[home, data.home.label]];
  if (data.zone) {
    const [from, to] = data.zone.map(at);
    const band = {x: from, width: Math.max(to - from, 1), y: 22, height: RULER - 22};
    draw(fixed, "rect", {...band, fill: "var(--ok)", opacity: 0.13});
    labels.push([(from + to) / 2, "in sync"]);
  }
  draw(fixed, "line", {x1: home, x2: home, y1: 22, y2: RULER, ...line});
  draw(rail, "line", {x1: 0, x2: width, y1: RAIL - 24, y2: RAIL - 24, stroke: "var(--steel)", "stroke-width": 5});
  data.ends.forEach((end, i) => {
    if (end === null) return;
    drawEnd(at(end), i === 0 ? -1 : 1);
    labels.push([at(end), "end"]);
  });
  writeLabels(labels);
  ruler(scale, RULER, data.window, at, data.slave_unit);
}

/** Write texts above places, from left to right: those of one place together; one that would touch the one before it is
 * moved on. */
function writeLabels(labels) {
  const places = [];
  for (const [x, text] of labels.sort(([a], [b]) => a - b)) {
    if (places.length && x - places.at(-1)[0] < 1) places.at(-1)[1] += `, ${text}`;
    else places.push([x, text]);
  }
  let right = -Infinity;
  for (const [x, text] of places) {
    const label = draw(fixed, "text", {y: 13, "text-anchor": "middle", text}), half = label.getComputedTextLength() / 2;
    const middle = Math.max(x, right + 6 + half);
    set(label, {x: middle});
    right = middle + half;
  }
}

/** An end position: a bumper at the carriage's farther side, and the place that the tool may not pass. */
function drawEnd(x, side) {
  draw(fixed, "line", {x1: x, x2: x, y1: 22, y2: RULER, stroke: "var(--limit)", "stroke-dasharray": "6 4"});
  const bumper = {x: x + side * 27 - (side < 0 ? 8 : 0), y: RAIL - 16, width: 8, height: 30, rx: 2};
  draw(rail, "rect", {...bumper, fill: "var(--limit)"});
}

// --- the machine at a time ---

function show(t) {
  const [master, lineVelocity] = smooth(data.master, t), [slave, velocity] = smooth(data.slave, t);
  const done = cuts.filter((cut) => cut.end <= t);
  showMaterial(t, master, done);
  const nearest = showMarks(t, master, slave, done);
  const x = at(slave), depth = lowered(t);
  set(carriage, {transform: `translate(${x.toFixed(3)} 0)`});
  set(tool, {transform: `translate(0 ${(depth * (SAW ? BOTTOM - TOP + 15 : 38)).toFixed(2)})`});
  const ahead = 80 * velocity / (data.fastest || 1);
  set(slaveArrow, {d: arrow(Math.sign(ahead) * 33, RAIL - 1, ahead)});
  set(lineArrow, {d: arrow(EDGE, LINE, 80 * ratio * lineVelocity / (data.fastest || 1))});
  const down = held(data.down, t) !== 0;
  Object.assign(carriage.dataset, {slavePosition: slave, slaveVelocity: velocity, x, tool: down ? "down" : "up"});
  Object.assign(stock.dataset, {masterPosition: master, cuts: done.length});
  const slow = 1e-4 * data.fastest || 1e-3;
  showReadout(SAW ? "saw" : "slave", number(slave, data.slave_unit));
  showReadout("velocity", number(velocity, `${data.slave_unit}/s`, slow));
  showReadout(SAW ? "material" : "master velocity", lineSpeed(lineVelocity, slow));
  if (data.marks) showReadout(data.pieces ? "saw to next cut" : SAW ? "saw to mark" : "slave to product", nearest);
  if (data.request) showReadout("asked of the line", lineSpeed(held(data.request, t), slow));
  if (data.pieces) showPieces(done);
  else if (data.cuts.length) showReadout("cuts", `${done.length} of ${data.cuts.length}`);
}

/** How far the tool is down: 0 to 1. */
function lowered(t) {
  const i = last(data.down.t, t), since = i ? (t - data.down.t[i]) / LOWERING : 1, u = Math.min(since, 1);
  const eased = u * u * (3 - 2 * u);
  return data.down.x[i] ? eased : 1 - eased;
}

/** The bodies into which the cuts have parted the material: their ends, null where one is endless, and their names. */
function bodies(done) {
  if (data.pieces) return partedMaterial(done);
  const borders = done.map((cut) => cut.place).sort((a, b) => flow * ratio * (b - a)); // from upstream on
  return Array.from({length: borders.length + 1}, (_, i) => {
    const [upstream, downstream] = [borders[i - 1] ?? null, borders[i] ?? null];
    const text = i === 0 ? "" : i === borders.length ? "front end" : `piece ${borders.length - i}`;
    return {upstream, downstream, text, fill: "var(--wood)"};
  });
}

function showMaterial(t, master, done) {
  const where = (place) => at(ratio * (master - place));
  const endless = flow > 0 ? [-GAP, width + GAP] : [width + GAP, -GAP];
  const shown = [];
  let named = 0;
  for (const {upstream, downstream, text, fill} of bodies(done)) {
    const inside = upstream === null ? downstream + flow * ratio
      : downstream === null ? upstream - flow * ratio : (upstream + downstream) / 2;
    const shift = done.length ? taken(inside, master, done, {flow, length}) : 0;
    const from = upstream === null ? endless[0] : where(upstream) + shift;
    const to = downstream === null ? endless[1] : where(downstream) + shift;
    const x = Math.max(Math.min(from, to), -GAP), end = Math.min(Math.max(from, to), width + GAP);
    if (end <= x) continue;
    pieces.use(shown.length, {x, width: end - x, y: SAW ? TOP : BOTTOM - 8, height: SAW ? BOTTOM - TOP : 8, fill});
    shown.push([x, end]);
    if (text && end - x > Math.max(80, 7.5 * text.length)) {
      names.use(named++, {x: (x + end) / 2, y: (TOP + BOTTOM) / 2 + 4, text});
    }
  }
  pieces.end(shown.length);
  names.end(named);
  showKerf(t, where);
  showGrain(master, where, done, shown);
  showRollers(master);
}

function showKerf(t, where) {
  const cut = cuts.find(({begin, end}) => begin <= t && t < end);
  if (cut) set(kerf, {x1: where(cut.place), x2: where(cut.place), y2: TOP + lowered(t) * (BOTTOM - TOP)});
  set(kerf, {visibility: cut ? "visible" : "hidden"});
}

/** Short lines, fixed on the material; `shown`: the ends of the bodies that are seen, in px. */
function showGrain(master, where, done, shown) {
  const distance = GRAIN / Math.abs(length(ratio));
  const edges = [low - 0.05 * (high - low), high + 0.05 * (high - low)].map((x) => master - x / ratio).sort((a, b) => a - b);
  let count = 0;
  for (let n = Math.floor(edges[0] / distance); n * distance <= edges[1]; n++) {
    const x = where(n * distance) + taken(n * distance, master, done, {flow, length}), y = SAW ? TOP + 6 + (n * 7919 & 3) * 7 : BOTTOM - 4;
    if (!shown.some(([from, to]) => from <= x - 8 && x + 8 <= to)) continue; // it would stick out
    grain.use(count++, {d: `M${(x - 7).toFixed(2)} ${y}h${SAW ? 14 : 8}`});
  }
  grain.end(count);
}

/** Rollers under the material, which turn with it. */
function showRollers(master) {
  const radius = 7, distance = 64, count = Math.ceil(width / distance);
  const angle = length(ratio * master) / radius % (2 * Math.PI), dx = radius * Math.cos(angle), dy = radius * Math.sin(angle);
  for (let i = 0; i < count; i++) {
    const x = (i + 0.5) * distance, round = `M${x - radius} ${ROLLERS - 3}a${radius} ${radius} 0 1 0 ${2 * radius} 0`;
    const spoke = `M${(x - dx).toFixed(2)} ${(ROLLERS - 3 - dy).toFixed(2)}L${(x + dx).toFixed(2)} ${(ROLLERS - 3 + dy).toFixed(2)}`;
    spokes.use(i, {d: `${round}a${radius} ${radius} 0 1 0 ${-2 * radius} 0${spoke}`});
  }
  spokes.end(count);
}

/** The places of the marks near the window, with their numbers. */
function marksIn(t, master, done) {
  if (!data.marks) return [];
  if (data.marks.next) return nextCut(t, done);
  const edges = [low, high].map((x) => master - x / ratio).sort((a, b) => a - b), margin = 0.06 * (edges[1] - edges[0]);
  const {offset, length: distance, places} = data.marks;
  if (places) return places.map((place, i) => [i + 1, place]).filter(([, p]) => edges[0] - margin < p && p < edges[1] + margin);
  const first = Math.ceil((edges[0] - margin - offset) / distance), final = Math.floor((edges[1] + margin - offset) / distance);
  if (final - first > width / 8) return []; // they would run together
  return Array.from({length: final - first + 1}, (_, i) => [first + i, offset + (first + i) * distance]);
}

/** Whether a cut is under way. */
function underWay(t) {
  return cuts.some(({begin, end}) => begin <= t && t < end);
}

/** The next cut, if it is known and the blade is not yet in the material: number and place. */
function nextCut(t, done) {
  return held(data.marks.shown, t) && !underWay(t) ? [[done.length + 1, held(data.marks.next, t)]] : [];
}

/** The mark that is nearest to the tool: its number and place; nothing if there are none. */
function nearestMark(t, master, slave, done) {
  if (data.marks?.next) return nextCut(t, done)[0];
  const place = master - slave / ratio, {offset, length: distance, places} = data.marks ?? {};
  if (places) {
    const i = places.reduce((best, p, j) => Math.abs(p - place) < Math.abs(places[best] - place) ? j : best, 0);
    return places.length ? [i + 1, places[i]] : null;
  }
  const n = data.marks ? Math.round((place - offset) / distance) : 0;
  return data.marks ? [n, offset + n * distance] : null;
}

/** Draw the marks and the distance to the nearest one; the result is that distance as a text. */
function showMarks(t, master, slave, done) {
  const cut = new Set(cuts.filter(({begin}) => begin <= t).map(({mark}) => Math.round(mark / data.within)));
  let count = 0;
  for (const [n, place] of marksIn(t, master, done)) {
    const x = at(ratio * (master - place)) + taken(place, master, done, {flow, length});
    if (SAW && cut.has(Math.round(place / data.within))) continue;
    const box = `M${x - 11} ${BOTTOM - 9}v-22h22v22Z`, line = `M${x.toFixed(3)} ${TOP - 4}V${BOTTOM}`;
    marks.use(count, {d: SAW ? line : box, "data-mark": n});
    flags.use(count++, {x, y: SAW ? TOP - 8 : BOTTOM - 16, text: n});
  }
  marks.end(count);
  flags.end(count);
  const nearest = nearestMark(t, master, slave, done);
  if (!nearest) return data.pieces && underWay(t) ? "0, cutting" : "none";
  const away = slave - ratio * (master - nearest[1]);
  root.dataset.distance = away;
  showDistance(at(slave), at(slave - away), number(away, data.slave_unit));
  return `${number(away, data.slave_unit)} (${data.pieces ? "cut" : SAW ? "mark" : "product"} ${nearest[0]})`;
}

function showDistance(saw, mark, text) {
  const seen = Math.abs(saw - mark) > 30 && mark > 0 && mark < width;
  set(measures, {visibility: seen ? "visible" : "hidden"});
  if (!seen) return;
  const side = Math.sign(mark - saw);
  set(dimension, {d: `M${saw} 102H${mark}M${saw + side * 6} 98.5L${saw} 102l${side * 6} 3.5M${mark - side * 6} 98.5L${mark} 102l${-side * 6} 3.5M${mark} 97V${TOP - 22}`});
  set(distance, {x: (saw + mark) / 2, text: Math.abs(saw - mark) > 90 ? text : ""});
}

/** What is drawn of this run. */
const legend = [
  [SAW ? "saw" : "slave", "--slave"],
  ...(data.pieces ? materialLegend() : [[SAW ? "material" : "conveyor, products", "--wood"]]),
  ...(data.marks && SAW ? [[data.marks.next ? "next cut" : "mark for a cut", "--ink", "dashes"]] : []),
  ...(data.zone ? [["range in sync", "--ok", "band"]] : []),
  ...(data.ends.some((end) => end !== null) ? [["end of the stroke", "--limit", "dashes"]] : []),
  ["velocity of the line", "--master", "line"],
];

return {resize, show, legend};
};
