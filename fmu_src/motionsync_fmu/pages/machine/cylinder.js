// The scene of a cylinder whose blades turn above moving material. All is in one scale. What is
// on the material at m is ratio (master - m) beyond the lowest point of the blades' circle, which they pass at position 0.
scenes.cylinder = () => {
const EDGE = 8, TOP = 22, THICK = 9, BIGGEST = 105; // px, as all that follows
const ARROWS = 46, RULER = 88, BELOW = 112; // below the lowest point of the blades' circle
const AROUND = 1.25; // of the circumference: the material that is shown at least
const CUT_AT = 0.4; // of the width: where the cut is made
const DROP = 60, FALL = 120; // the height of a fall; the way of the piece's end during which it falls
const GRAIN = 34; // between the lines by which one sees the material move
const {turn, circumference, blades, ratio} = data, radius = circumference / (2 * Math.PI);
const cuts = data.cuts.map((cut) => ({...cut, master: smooth(data.master, cut.end)[0]}));
let width = 600, scale = 1, bottom = 200;

const at = (distance) => CUT_AT * width + distance * scale; // along the material, beyond the cut
const length = (distance) => distance * scale;
const angle = (position) => 2 * Math.PI * position / turn; // from the lowest point on, with the material
/** A place on the circle of the blades, as its share of the radius. */
const on = (beyond, share) => [at(0) + share * radius * scale * Math.sin(beyond), bottom - radius * scale * (1 - share * Math.cos(beyond))];

const [ground, stock, marks, wheel, text] = ["ground", "stock", "marks", "cylinder", "text"].map((name) => draw(svg, "g", {class: name}));
const band = draw(ground, "rect", {fill: "var(--ok)", opacity: 0.13});
const tables = [0, 1].map(() => draw(ground, "rect", {height: 5, fill: "var(--steel)"}));
const anvil = draw(ground, "circle", {fill: "var(--paper)", stroke: "var(--muted)", "stroke-width": 2});
const spoke = draw(ground, "path", {stroke: "var(--muted)"});
const arrows = ["master", "slave"].map((axis) => draw(ground, "path", {stroke: `var(--${axis})`, fill: `var(--${axis})`, "stroke-width": 2}));
const arrowNames = ["material", "edge"].map((name) => draw(ground, "text", {class: "soft", text: name}));
const scaleLayer = draw(ground, "g");
const bodies = pool(stock, "rect", {stroke: "var(--edge)", height: THICK, rx: 1});
const grain = pool(stock, "path", {stroke: "var(--grain)", "stroke-width": 1.5});
const mark = draw(marks, "path", {stroke: "var(--ink)", "stroke-width": 1.5, "stroke-dasharray": "4 3"});
const circle = draw(wheel, "circle", {fill: "none", stroke: "var(--grid)", "stroke-dasharray": "3 4"});
const zone = draw(wheel, "path", {fill: "none", stroke: "var(--ok)", "stroke-width": 7, opacity: 0.5});
const body = draw(wheel, "g");
const rim = draw(body, "circle", {fill: "var(--paper)", stroke: "var(--slave)", "stroke-width": 3});
const holes = Array.from({length: 6}, () => draw(body, "circle", {fill: "var(--grid)"}));
draw(body, "circle", {r: 6, fill: "var(--slave)"});
const knives = Array.from({length: blades}, () => draw(body, "path", {class: "blade", fill: "var(--ink)"}));
const park = draw(wheel, "path", {stroke: "var(--muted)", "stroke-width": 2});
const parkName = draw(text, "text", {class: "soft halo", "text-anchor": "middle", text: "park"});
const markName = draw(text, "text", {class: "halo", "text-anchor": "middle"});
const syncName = draw(text, "text", {class: "halo", "text-anchor": "middle", text: "in sync"});
const names = pool(text, "text", {"text-anchor": "middle"});

/** Draw anew what depends on the width alone. */
function resize(pixels) {
  width = Math.max(pixels, 200);
  scale = Math.min(width / (AROUND * circumference), BIGGEST / radius);
  const r = radius * scale;
  bottom = TOP + 2 * r;
  svg.setAttribute("height", bottom + BELOW);
  set(circle, {cx: at(0), cy: bottom - r, r});
  set(rim, {r: 0.86 * r});
  holes.forEach((hole, i) => set(hole, {r: r / 12, transform: `rotate(${60 * i}) translate(0 ${0.45 * r})`}));
  const half = Math.min(5, Math.PI * r / blades / 3);
  knives.forEach((knife, i) => set(knife, {d: `M${-half} ${0.78 * r}L0 ${r}L${half} ${0.78 * r}Z`, transform: `rotate(${-360 * i / blades})`}));
  const parked = angle(data.park), [x, y] = on(parked, 1.16);
  set(park, {d: `M${on(parked, 0.9)}L${on(parked, 1.06)}`});
  set(parkName, {x: Math.max(x, 16), y: y + 4});
  const roll = Math.min(20, 0.3 * r);
  set(anvil, {cx: at(0), cy: bottom + roll, r: roll});
  set(tables[0], {x: 0, y: bottom + 1, width: Math.max(at(0) - roll - 4, 0)});
  set(tables[1], {x: at(0) + roll + 4, y: bottom + 1, width: Math.max(end() - at(0) - roll - 4, 0)});
  arrowNames.forEach((name, i) => set(name, {x: EDGE, y: bottom + ARROWS + 16 * i}));
  ruler(scaleLayer, bottom + RULER, [(EDGE - at(0)) / scale, (width - 30 - at(0)) / scale], at, data.unit);
}

/** Where the table ends, and a piece falls when it leaves it. */
const end = () => Math.min(at(0) + Math.max(radius * scale, 60), width - 40);

// --- the machine at a time ---

function show(t) {
  const [master, lineVelocity] = smooth(data.master, t), [slave, velocity] = smooth(data.slave, t);
  const done = cuts.filter((cut) => cut.end <= t), r = radius * scale;
  const fineness = 1e-4 * turn, shown = slave - turn * Math.floor(slave / turn + 0.05 * fineness / turn), inSync = held(data.in_sync, t) !== 0;
  set(body, {transform: `translate(${at(0).toFixed(3)} ${(bottom - r).toFixed(3)}) rotate(${(-360 * shown / turn).toFixed(4)})`});
  showWindow(t, inSync);
  showMaterial(master, done);
  const edge = velocity * circumference / turn, line = ratio * lineVelocity, way = 80 / (data.fastest || 1);
  [line, edge].forEach((speed, i) => set(arrows[i], {d: arrow(62, bottom + ARROWS - 4 + 16 * i, way * speed)}));
  const rolled = ratio * master * scale / Number(anvil.getAttribute("r")), roll = Number(anvil.getAttribute("r"));
  const [dx, dy] = [roll * Math.sin(rolled), roll * Math.cos(rolled)];
  set(spoke, {d: `M${(at(0) - dx).toFixed(2)} ${(bottom + roll + dy).toFixed(2)}L${(at(0) + dx).toFixed(2)} ${(bottom + roll - dy).toFixed(2)}`});
  Object.assign(wheel.dataset, {slavePosition: shown, slaveVelocity: velocity, inSync, scale});
  Object.assign(stock.dataset, {masterPosition: master, cuts: done.length, pixels: at(0)});
  const slow = 1e-4 * data.fastest || 1e-3;
  showReadout("knife", number(shown, data.slave_unit, fineness));
  showReadout("knife velocity", number(velocity, `${data.slave_unit}/s`, slow));
  showReadout("material", lineSpeed(lineVelocity, slow));
  showReadout("edge", number(edge, `${data.unit}/s`, slow));
  showReadout("next cut in", showMark(t, master, done));
  showReadout("asked of the line", lineSpeed(held(data.request, t), slow));
  showPieces(done);
}

/** The window of sync: on the material, and on the circle by what the blade turns meanwhile. */
function showWindow(t, inSync) {
  const {before, after, overspeed} = Object.fromEntries(Object.entries(data.sync).map(([name, signal]) => [name, held(signal, t)]));
  const rotation = (distance) => data.along_material ? Math.asin(Math.min(distance / radius, 1)) : distance / radius * (1 + overspeed);
  const r = (radius * scale).toFixed(3), wide = rotation(before) + rotation(after) > Math.PI ? 1 : 0;
  set(zone, {d: `M${on(-rotation(before), 1)}A${r} ${r} 0 ${wide} 0 ${on(rotation(after), 1)}`, opacity: inSync ? 0.9 : 0.4});
  set(band, {x: at(-before), width: Math.max(length(before + after), 1), y: bottom - 40, height: RULER + 40});
  set(syncName, {x: at((after - before) / 2), y: bottom + RULER - 8});
}

function showMaterial(master, done) {
  const where = (place) => at(ratio * (master - place)), shown = [];
  let named = 0, lines = 0;
  for (const {upstream, downstream, text: name, fill} of partedMaterial(done)) {
    const shift = upstream === null ? 0 : taken((upstream + downstream) / 2, master, done, {flow: 1, length});
    const from = upstream === null ? -10 : where(upstream) + shift, to = downstream === null ? width + 10 : where(downstream) + shift;
    const fallen = upstream === null ? 0 : Math.max(from - end(), 0) / FALL;
    if (to <= from || to < 0 || from > width + 10 || fallen >= 1) continue;
    const tilt = 30 * fallen * Math.min(1, 150 / (to - from));
    const transform = fallen ? `translate(0 ${(DROP * fallen * fallen).toFixed(2)}) rotate(${tilt.toFixed(2)} ${from.toFixed(2)} ${bottom})` : "";
    const x = Math.max(from, -10), right = Math.min(to, width + 10);
    bodies.use(shown.length, {x, width: right - x, y: bottom - THICK, fill, transform, opacity: 1 - fallen ** 4, "data-end": upstream ?? ""});
    shown.push(name);
    lines = showGrain(lines, [from, to], transform, master, shift);
    if (name && !fallen && right - x > Math.max(80, 7.5 * name.length)) {
      names.use(named++, {x: (Math.max(x, 0) + Math.min(right, width)) / 2, y: bottom + THICK + 12, text: name});
    }
  }
  bodies.end(shown.length);
  grain.end(lines);
  names.end(named);
}

/** Short lines, fixed on one body of the material, whose ends are given; the result is how many lines are drawn then. */
function showGrain(first, [from, to], transform, master, shift) {
  const distance = GRAIN / scale / ratio, place = (x) => master - (x - shift - at(0)) / scale / ratio;
  let count = first;
  for (let n = Math.ceil(place(Math.min(to, width)) / distance); n * distance < place(Math.max(from, 0)); n++) {
    const x = at(ratio * (master - n * distance)) + shift;
    if (from <= x - 6 && x + 6 <= to) grain.use(count++, {d: `M${(x - 5).toFixed(2)} ${bottom - THICK / 2 + (n & 1 ? 1.5 : -1.5)}h10`, transform});
  }
  return count;
}

/** Draw the place of the next cut; the result is how far it is still away, as a text. */
function showMark(t, master, done) {
  const place = held(data.marks.next, t), away = ratio * (place - master), x = at(-away);
  const seen = held(data.marks.shown, t) !== 0 && away > 0;
  set(mark, {visibility: seen ? "visible" : "hidden"});
  set(markName, {visibility: seen && x > EDGE && x < at(0) - 30 ? "visible" : "hidden"}); // the blade would hide it
  set(mark, {d: `M${x.toFixed(3)} ${bottom - THICK - 5}V${bottom}`});
  set(markName, {x, y: bottom - THICK - 9, text: done.length + 1});
  return seen ? number(away, data.unit, 1e-4 * circumference) : "none";
}

const legend = [
  ["knife", "--slave", "line"],
  ["its blades", "--ink"],
  ...materialLegend(),
  ["next cut", "--ink", "dashes"],
  ["window of a cut, in which the edge is in sync", "--ok", "band"],
];

return {resize, show, legend};
};
