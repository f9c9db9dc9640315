// The scene of two axes that may be coupled. A rotary axis is a disc, whose 0 is at the
// top and which turns clockwise; a linear axis is a rail.
scenes.axes = () => {
const FREE = 0, COUPLED = 2;
const BIGGEST = 84, EDGE = 34, TOP = 26; // px
const discs = data.axes.some(({period}) => period > 0); // side by side; rails are one above the other
let width = 600, radius = BIGGEST;

const link = draw(svg, "g", {class: "link"});
const belts = [0, 1].map(() => draw(link, "path", {fill: "none", "stroke-width": 2.5}));
const drawn = data.axes.map((axis, i) => (axis.period ? disc : rail)(axis, i, draw(svg, "g", {class: axis.name})));

/** The middle of an axis' place, in px, and the width that it has. */
function place(i) {
  if (discs) return {x: width * (i ? 0.73 : 0.27), y: TOP + radius, length: 0.4 * width};
  return {x: width / 2, y: i ? 150 : 72, length: width - 2 * EDGE};
}

/** What an axis shows beside its own hand: marks and stretches, each hidden where its `shown` is 0. */
function marksOf(axis, layer) {
  return axis.marks.map((mark) => {
    const colour = mark.at ? "var(--muted)" : "var(--ok)";
    const line = draw(layer, "path", {fill: "none", stroke: colour, "stroke-width": mark.at ? 2 : 7, opacity: mark.at ? 1 : 0.5});
    return {...mark, line};
  });
}

/** Their names, above whatever moves. */
function nameMarks(marks, layer) {
  for (const mark of marks) {
    mark.text = draw(layer, "text", {class: "soft halo", "text-anchor": "middle", text: mark.label});
  }
}

function disc(axis, i, layer) {
  const colour = `var(--${axis.name})`;
  const rim = draw(layer, "circle", {fill: "var(--paper)", stroke: colour, "stroke-width": 3});
  const dial = draw(layer, "g"), marks = marksOf(axis, layer), hand = draw(layer, "g", {class: "hand"});
  const holes = Array.from({length: 6}, () => draw(hand, "circle", {fill: "var(--grid)"}));
  const pointer = draw(hand, "path", {fill: colour});
  draw(hand, "circle", {r: 9, fill: colour});
  nameMarks(marks, layer);
  const name = draw(layer, "text", {"text-anchor": "middle", text: `${axis.name}${axis.unit ? `, ${axis.unit}` : ""}`});
  const angle = (position) => 2 * Math.PI * position / axis.period;
  const on = (position, r) => `${(r * Math.sin(angle(position))).toFixed(2)} ${(-r * Math.cos(angle(position))).toFixed(2)}`;
  return {
    resize() {
      const {x, y} = place(i);
      set(layer, {transform: `translate(${x} ${y})`});
      set(rim, {r: radius});
      set(name, {y: radius + 40});
      set(pointer, {d: `M-4 0L0 ${6 - radius}L4 0Z`});
      holes.forEach((hole, k) => set(hole, {r: radius / 12, transform: `rotate(${60 * k}) translate(0 ${-0.45 * radius})`}));
      dial.replaceChildren();
      for (let k = 0; k < 24; k++) {
        draw(dial, "line", {y1: -radius, y2: 5 - radius + (k % 6 ? 0 : 5), transform: `rotate(${15 * k})`, stroke: "var(--muted)"});
      }
      for (let k = 0; k < 4; k++) {
        const [dx, dy] = [[0, -radius - 7], [radius + 7, 4], [0, radius + 17], [-radius - 7, 4]][k];
        const anchor = ["middle", "start", "middle", "end"][k];
        draw(dial, "text", {x: dx, y: dy, class: "soft", "text-anchor": anchor, text: +(axis.period * k / 4).toPrecision(6)});
      }
    },
    show(t, position) {
      const shown = position - axis.period * Math.floor(position / axis.period);
      set(hand, {transform: `rotate(${(angle(shown) * 180 / Math.PI).toFixed(4)})`});
      for (const mark of marks) {
        const seen = !mark.shown || held(mark.shown, t) ? "visible" : "hidden";
        const from = held(mark.at ?? mark.from, t), to = held(mark.at ?? mark.to, t), r = radius - 8;
        const wide = to - from > axis.period / 2 ? 1 : 0, middle = (from + to) / 2;
        const arc = `M${on(from, r)}A${r} ${r} 0 ${wide} ${to > from ? 1 : 0} ${on(to, r)}`;
        set(mark.line, {visibility: seen, d: mark.at ? `M${on(from, radius + 4)}L${on(from, radius - 22)}` : arc});
        const [x, y] = on(middle, radius - 34).split(" ").map(Number);
        set(mark.text, {visibility: seen, x, y: y + 4});
      }
      return shown;
    },
    hold: () => ({...place(i), r: radius}),
  };
}

function rail(axis, i, layer) {
  const colour = `var(--${axis.name})`, scale = draw(layer, "g"), marks = marksOf(axis, layer);
  const carriage = draw(layer, "g", {class: "hand"});
  draw(carriage, "rect", {x: -29, y: -30, width: 58, height: 22, rx: 4, fill: colour});
  draw(carriage, "path", {d: "M-6 -8H6L0 0Z", fill: colour});
  draw(carriage, "text", {y: -15, class: "plate", text: axis.name});
  nameMarks(marks, layer);
  const [low, high] = axis.range;
  const at = (position) => place(i).x - place(i).length / 2 + (position - low) / (high - low) * place(i).length;
  let x = 0;
  return {
    resize() {
      ruler(scale, place(i).y, axis.range, at, axis.unit);
    },
    show(t, position) {
      x = at(position);
      set(carriage, {transform: `translate(${x.toFixed(3)} ${place(i).y})`});
      for (const mark of marks) {
        const y = place(i).y, from = at(held(mark.at ?? mark.from, t)), to = at(held(mark.at ?? mark.to, t));
        const inside = Math.max(from, to) > 0 && Math.min(from, to) < width;
        const seen = inside && (!mark.shown || held(mark.shown, t)) ? "visible" : "hidden";
        set(mark.line, {visibility: seen, d: mark.at ? `M${from} ${y - 34}V${y + 4}` : `M${from} ${y}H${to}`});
        set(mark.text, {visibility: seen, x: (from + to) / 2, y: y - 40});
      }
      return position;
    },
    hold: () => ({x, y: place(i).y - 19, r: 0}),
  };
}

/** The coupling: a belt round both discs, a rod between two carriages; dashed while it comes or goes. */
function showLink(coupling) {
  set(link, {visibility: coupling === FREE ? "hidden" : "visible"});
  const [a, b] = drawn.map((axis) => axis.hold());
  const style = {stroke: coupling === COUPLED ? "var(--ok)" : "var(--muted)", "stroke-dasharray": coupling === COUPLED ? "none" : "6 5"};
  [-1, 1].forEach((side, i) => {
    const d = `M${a.x.toFixed(2)} ${a.y + side * a.r}L${b.x.toFixed(2)} ${b.y + side * b.r}`;
    set(belts[i], {d, ...style});
  });
}

function resize(pixels) {
  width = Math.max(pixels, 300);
  radius = Math.min(BIGGEST, 0.15 * width);
  svg.setAttribute("height", discs ? 2 * radius + 76 : 190);
  drawn.forEach((axis) => axis.resize());
}

function show(t) {
  const [master, masterVelocity] = smooth(data.master, t), [slave, velocity] = smooth(data.slave, t);
  const [shownMaster, shownSlave] = [master, slave].map((position, i) => drawn[i].show(t, position));
  const coupling = held(data.coupling, t);
  showLink(coupling);
  const layer = svg.querySelector("g.slave");
  Object.assign(layer.dataset, {slavePosition: shownSlave, slaveVelocity: velocity, coupling});
  const fineness = 1e-4 * data.span, [of, to] = data.axes;
  showReadout("master", number(shownMaster, of.unit, fineness));
  showReadout("slave", number(shownSlave, to.unit, fineness));
  showReadout("master velocity", number(masterVelocity, `${of.unit}/s`, fineness));
  showReadout("slave velocity", number(velocity, `${to.unit}/s`, fineness));
  showReadout("coupling", ["none", "changing", "in step"][coupling]);
}

const stretches = data.axes.flatMap(({marks}) => marks).filter((mark) => !mark.at).map((mark) => mark.label);
const legend = [
  ["master", "--master"],
  ["slave", "--slave"],
  ["in step", "--ok", "line"],
  ["coming in step, or leaving it", "--muted", "dashes"],
  ...[...new Set(stretches)].map((label) => [`range: ${label}`, "--ok", "band"]),
];

return {resize, show, legend};
};
