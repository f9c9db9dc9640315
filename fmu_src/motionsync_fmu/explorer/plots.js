"use strict";
// The plots of a run: the slave, what it follows, of a measured line also what the block takes for that, and, dashed, the slave
// before anything was changed.

const HEIGHTS = [190, 130, 130, 110]; // px
const AXIS = 26; // px, of the times below the last plot
const VALUES = 62, LABEL = 18; // px, beside a plot: the values of an axis, and its label
const NONE = "none";

/** A number at an axis: of six digits, and never longer than fits beside its label. */
function numberText(value) {
  const rounded = Number(value.toPrecision(6)), size = Math.abs(rounded);
  return rounded && (size < 1e-4 || size >= 1e6) ? rounded.toExponential() : String(rounded);
}

const colour = (name) => () => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** A list of plots, each with a label, units and the columns of a run: any of `slave`, `other` and `smoothed`; `names`: what
 * these are; `unit`: that of the slave, `masters`: that of the others. */
function plotsOf(block, another, {encoder, axis, cuts}) {
  const declared = new Map(block.variables.map((v) => [v.name, v]));
  const unitOf = (name) => declared.get(name)?.unit;
  const of = (name, other, smoothed, masters = unitOf(name)) => ({
    label: name.replace("slave.", ""),
    unit: unitOf(name),
    masters,
    stepped: false,
    names: {slave: "slave", other: block.roles.CYCLE_INDEX ? "telegram" : "master", smoothed: "smoothed master"},
    columns: (course) => ({
      slave: course.column(name),
      other: other?.(course),
      smoothed: encoder && smoothed ? course.column(smoothed) : undefined,
    }),
  });
  const off = {label: "master off by", unit: "POSITION", names: {}, columns: (course) => ({smoothed: masterErrors(course)})};
  const against = againstPosition(block, cuts), position = against === "master" ? "POSITION" : unitOf("slave.position");
  const plots = block.roles.CYCLE_INDEX
    ? remotePlots(of)
    : [
        withNames(of("slave.position", (course) => positions(course, block), undefined, position), {other: against}),
        of("slave.velocity", (course) => course.axis(1), "master.smoothed_velocity", "VELOCITY"),
        of("slave.acceleration", (course) => course.axis(2), undefined, "ACCELERATION"),
        ...(declared.has("slave.jerk") ? [of("slave.jerk")] : []),
        ...(encoder && !axis.times ? [off] : []), // of a recorded line nobody knows the true position
      ];
  if (declared.has(another))
    plots.push({...of(another), label: another, stepped: declared.get(another).kind !== "Real"});
  return plots;
}

/** The unit of what is not the slave's, which is the slave's unless the plot says otherwise. */
const mastersUnit = ({unit, masters = unit}) => masters;

const withNames = (plot, names) => ({...plot, names: {...plot.names, ...names}});

/** What the slave's position is compared with. */
function againstPosition(block, cuts) {
  return block.roles.PIECES ? "next cut" : cuts.while ? "next mark" : "master";
}

/** Of a remote axis: how far it is off, since its position and the slave's look alike. */
function remotePlots(of) {
  const late = (values) => [null, ...values];
  return [
    {
      label: "off by",
      unit: "POSITION",
      names: {slave: "slave", other: "telegram"},
      columns: (course) => ({slave: late(course.errors.corrected_position), other: late(course.errors.position)}),
    },
    {
      label: "index off by",
      unit: "NONE",
      names: {slave: "slave", other: "telegram"},
      columns: (course) => ({slave: late(course.errors.corrected_index), other: late(course.errors.index)}),
    },
    of("slave.velocity", (course) => course.axis(1)),
    of("slave.acceleration", (course) => course.axis(2)),
  ];
}

/** What the slave's position is compared with: the next mark or cut on the material where there is one, else the master. */
function positions(course, block) {
  const master = course.axis(0), {cuts, start} = course.scenario, slave = course.column("slave.position");
  const margin = 0.25 * span(slave), low = least(slave) - margin, high = greatest(slave) + margin;
  const near = (x) => (low <= x && x <= high ? x : null);
  if (cuts.while) {
    const {length, offset = 0, ratio = 1} = cuts, first = Math.ceil(low / ratio / length);
    return Array.from(master, (m) => near(ratio * (modulo(m - offset - first * length, length) + first * length)));
  }
  const [picture] = block.pictures;
  if (picture?.next_cut) {
    const run = new Run(course, block), place = nextCuts(run, picture, piecesOf(run)), determined = course.column(picture.next_cut_shown);
    const factor = course.column(block.piece_variables.coupling_factor);
    return Array.from(master, (m, k) => (determined[k] ? near((factor[k] || 1) * (m - place[k])) : null));
  }
  const period = start["master.period"] ?? 0;
  return period ? broken(master.map((m) => modulo(m, period)), period) : master;
}

/** A line that does not cross the picture where a period ends. */
function broken(values, period) {
  return Array.from(values, (x, k) => (k && Math.abs(x - values[k - 1]) > period / 2 ? null : x));
}

/** All plots on the page, over one stretch of time. */
class Plots {
  /** `chosen(t)` is called when the user points at a time. */
  constructor(box, block, chosen) {
    Object.assign(this, {box, block, chosen, drawn: [], zoom: null, now: 0, course: null, before: null, another: NONE});
    new ResizeObserver(() => this.#resize()).observe(box);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () =>
      this.drawn.forEach(({plot}) => plot.redraw(false)),
    );
  }

  /** Show a run, and the one before anything was changed. */
  show(course, before) {
    if (Boolean(course.scenario.encoder) !== Boolean(this.course?.scenario.encoder)) this.renew();
    if (!this.drawn.length) this.#make(course.scenario);
    Object.assign(this, {course, before});
    for (const {plot, of} of this.drawn) plot.setData(this.#rows(of), false);
    this.#scale();
  }

  /** Draw another set of plots at the next run. */
  renew(another = this.another) {
    this.drawn.forEach(({plot}) => plot.destroy());
    this.box.replaceChildren();
    Object.assign(this, {drawn: [], another});
  }

  /** All curves that are drawn, at all points of the run, as a file of comma-separated values. */
  table() {
    const units = this.block.units[this.course.scenario.units];
    const columns = this.drawn.flatMap(({of}) => Object.entries(of.columns(this.course)).filter(([, values]) => values).map(([key, values]) =>
      [[of.label, of.names[key], units[key === "slave" ? of.unit : mastersUnit(of)]].filter(Boolean).join(" "), values]));
    const rows = Array.from(this.course.time, (t, k) => [t, ...columns.map(([, values]) => values[k] ?? "")].join(","));
    return [["time s", ...columns.map(([heading]) => heading)].join(","), ...rows, ""].join("\n");
  }

  /** Show a stretch of time; null: the whole run. */
  stretch(zoom) {
    this.zoom = zoom;
    this.#scale();
  }

  /** Show a time as a line in each plot; a plot that is drawn anew asks for it, too. */
  mark(t) {
    this.now = t;
    for (const {plot, line} of this.drawn) {
      const {min, max} = plot.scales.x;
      line.style.transform = `translateX(${plot.valToPos(t, "x").toFixed(1)}px)`;
      line.hidden = t < min || t > max;
    }
  }

  #rows(of) {
    const {slave, other, smoothed} = of.columns(this.course), empty = () => new Array(this.course.count).fill(null);
    const beforehand = slave && this.before !== this.course ? this.#beforehand(of) : empty();
    return [this.course.time, slave ?? empty(), smoothed ?? empty(), other ?? empty(), beforehand];
  }

  /** The same of the run before, at the points of this one. */
  #beforehand(of) {
    const {slave} = of.columns(this.before), {time} = this.before, {close} = this.block.runner;
    return Array.from(this.course.time, (t) =>
      t <= time.at(-1) + close ? slave[Math.max(bisect(time, t + close, true) - 1, 0)] : null,
    );
  }

  #make(scenario) {
    const units = this.block.units[scenario.units], name = (unit) => units[unit] ?? "";
    const plots = plotsOf(this.block, this.another, scenario);
    const differs = (of) => name(of.unit) !== name(mastersUnit(of)), right = plots.some(differs) ? VALUES + LABEL : 0;
    plots.forEach((of, i, all) => {
      const frame = newElement("div", {className: "plot"}), line = newElement("div", {className: "now"});
      this.box.append(frame);
      const plot = new uPlot(
        this.#options(of, name(of.unit), HEIGHTS[Math.min(i, 3)], i === all.length - 1, right, differs(of) ? name(of.masters) : null),
        [[0], [0], [0], [0], [0]],
        frame,
      );
      plot.over.append(line);
      plot.over.addEventListener("click", (event) => this.chosen(plot.posToVal(event.offsetX, "x")));
      plot.over.addEventListener("dblclick", () => this.stretch(null));
      this.drawn.push({plot, of, line});
    });
  }

  /** `right`: px beside the plots; `masters`: the unit of an axis of its own there, for what is not the slave's. */
  #options(of, unit, height, final, right, masters) {
    const axis = {
      stroke: colour("--muted"),
      grid: {stroke: colour("--grid"), width: 1},
      ticks: {stroke: colour("--grid"), width: 1},
      font: "11px system-ui",
    };
    const label = `${of.label}${unit ? ` ${unit}` : ""}`,
      line = (name, more) => ({stroke: colour(name), points: {show: false}, pxAlign: 0, ...more}), // 1: a slope has steps
      texts = (_, ticks) => ticks.map(numberText),
      side = {...axis, size: VALUES, labelSize: LABEL, labelFont: "12px system-ui", space: 20, values: texts},
      own = masters === null ? {} : {scale: "masters"};
    const paths = of.stepped ? {paths: uPlot.paths.stepped({align: -1})} : {};
    return {
      width: Math.max(this.box.clientWidth, 200),
      height: height + (final ? AXIS : 0),
      legend: {show: false},
      padding: [8, 12 + (masters === null ? right : 0), final ? 0 : 8, 0],
      cursor: {drag: {x: true, y: false}, points: {show: false}, sync: {key: "run"}},
      scales: {x: {time: false}, masters: {range: (_, low, high) => (low || high ? uPlot.rangeNum(low, high, 0.1, true) : [-1, 1])}},
      axes: [
        {...axis, size: final ? AXIS : 0, values: final ? undefined : (_, ticks) => ticks.map(() => "")},
        {...side, label},
        ...(masters === null ? [] : [{...side, ...own, side: 1, label: `master ${masters}`, grid: {show: false}}]),
      ],
      series: [
        {},
        line("--slave", {width: 2, ...paths}),
        line("--third", {width: 2.5, ...own}), // the true master is on top of what is taken for it
        line("--master", {width: 1.3, ...own}),
        line("--reference", {width: 1.2, dash: [4, 3], ...paths}),
      ],
      hooks: {drawClear: [(plot) => this.#shade(plot)], draw: [() => this.mark(this.now)], setSelect: [(plot) => this.#selected(plot)]},
    };
  }

  #selected(plot) {
    const {left, width} = plot.select;
    if (width > 4) this.stretch([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
    plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
  }

  #shade(plot) {
    if (!this.course || !this.block.shaded) return;
    const {ctx, bbox} = plot,
      x = (t) => Math.min(Math.max(plot.valToPos(t, "x", true), bbox.left), bbox.left + bbox.width);
    ctx.save();
    ctx.fillStyle = colour("--cut")();
    for (const [first, after] of intervals(this.course.column(this.block.shaded))) {
      const begin = x(this.course.time[first]), end = x(this.course.time[after - 1]);
      if (end > begin) ctx.fillRect(begin, bbox.top, end - begin, bbox.height);
    }
    ctx.restore();
  }

  #scale() {
    const [min, max] = this.zoom ?? [0, this.course.scenario.stop_time];
    for (const {plot} of this.drawn) plot.setScale("x", {min, max});
  }

  #resize() {
    for (const {plot} of this.drawn) plot.setSize({width: Math.max(this.box.clientWidth, 200), height: plot.height});
  }
}
