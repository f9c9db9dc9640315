"use strict";
// Draws the charts of a page: colours of a light or a dark page, one stretch of time and one cursor for all charts.
(() => {
  const frames = [...document.querySelectorAll("div.plot")];
  const texts = frames.map((frame) => frame.nextElementSibling.textContent);
  const PAPER = 703;  // px: the width of A4 less its margins
  const NUMBER = 22;  // px: from the middle of a number to that of the next one, at least
  const config = {
    displaylogo: false, doubleClick: "reset", plotlyServerURL: "",
    modeBarButtons: [["toImage", "zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d"]],  // none that sends data
  };
  // The columns of a chart with bars over time: the value of each lane, at each time at which one of them changes, and at
  // those of other columns. A lane has a value where it has no bar, too, if it is true or false.
  function lanes(data, others) {
    const bars = data.filter(({ base, meta }) => base && meta), end = ({ base, x }, i) => +(base[i] + x[i]).toPrecision(9);
    const changes = bars.flatMap((bar) => bar.base.flatMap((at, i) => [at, end(bar, i)]));
    const x = [...new Set([...changes, ...others.flatMap((column) => column.x)])].sort((a, b) => a - b);
    return [...new Set(bars.map(({ meta }) => meta))].reverse().map((heading) => {
      const own = bars.filter(({ meta }) => meta === heading), begins = new Map(), ends = new Set();
      for (const bar of own) bar.base.forEach((at, i) => { begins.set(at, bar.name); ends.add(end(bar, i)); });
      const none = own.some(({ name }) => name === "true") ? "false" : "";
      let value = none;
      const values = x.map((at, i) => {
        if (ends.has(at) && i < x.length - 1) value = none;
        return value = begins.get(at) ?? value;
      });
      return { heading, x, values };
    });
  }

  const column = ({ meta, x, y }) => ({ heading: meta.heading ?? meta, x, values: meta.texts ?? y });

  // What a chart shows as comma-separated values: a row for each value of the horizontal axis that a column has, and another
  // one where a column has it again.
  function table({ data, layout }) {
    const curves = data.filter(({ base, meta }) => meta && !base).map(column), rows = new Map();
    const columns = [...lanes(data, curves), ...curves];
    columns.forEach(({ x, values }, k) => x.forEach((at, i) => {
      if (at === null || values[i] === null) return;
      if (!rows.has(at)) rows.set(at, []);
      let row = rows.get(at).find((cells) => cells[k] === "");
      if (!row) rows.get(at).push(row = new Array(columns.length).fill(""));
      row[k] = values[i];
    }));
    const quoted = (text) => `"${text.replaceAll('"', '""')}"`, cell = (value) => /[",\n]/.test(value) ? quoted(value) : value;
    const lines = [...rows].sort(([a], [b]) => a - b).flatMap(([at, all]) => all.map((cells) => [at, ...cells.map(cell)].join(",")));
    return [[layout.xaxis.title.text, ...columns.map(({ heading }) => heading)].map(quoted).join(","), ...lines, ""].join("\n");
  }

  const csv = {
    name: "csv", title: "Download as CSV",
    icon: { width: 24, height: 24, path: "M5 21h14v-2H5zM19 9h-4V3H9v6H5l7 7z" },
    click(frame) {
      const name = `${frame.getAttribute("aria-label").replace(/[^\w]+/g, "_")}.csv`;
      const href = URL.createObjectURL(new Blob([table(frame)], { type: "text/csv" }));
      Object.assign(document.createElement("a"), { download: name, href }).click();
      URL.revokeObjectURL(href);
    },
  };

  // The settings of a chart; one without columns has nothing to download.
  function settings(data) {
    const [usual] = config.modeBarButtons, buttons = data.some(({ meta }) => meta) ? [csv, ...usual] : usual;
    return { ...config, modeBarButtons: [buttons] };
  }

  const isTimed = (frame) => frame.layout.meta.timed;
  let busy = false;

  // The figure of a chart; the name of a CSS property is replaced by its colour.
  function figure(text) {
    const style = getComputedStyle(document.documentElement);
    return JSON.parse(text, (_, value) =>
      typeof value === "string" && /^--[a-z0-9-]+$/.test(value) ? style.getPropertyValue(value).trim() || value : value);
  }

  // The texts of a chart that is so wide, in px, without numbers that would touch the one before.
  function apart({ annotations, margin, meta }, width) {
    const second = (width - margin.l - margin.r) / (meta.span[1] - meta.span[0]);
    let after = -Infinity;
    return annotations.filter(({ name, x }) => {
      if (name !== "number") return true;
      if (x * second < after) return false;
      after = x * second + NUMBER;
      return true;
    });
  }

  // Draw a chart with the current colours and width; its zoom and the curves that are hidden stay as they are.
  async function draw(frame, text) {
    const { data, layout } = figure(text);
    const isPrinted = document.documentElement.classList.contains("printed");
    layout.width = isPrinted ? PAPER : frame.clientWidth;
    if (isPrinted) layout.margin.r = layout.meta.right;
    layout.annotations = apart(layout, layout.width);
    for (const axis of Object.keys(layout).filter((key) => /^[xy]axis/.test(key) && frame.layout)) {
      layout[axis].autorange = frame.layout[axis].autorange;
      layout[axis].range = frame.layout[axis].range;
    }
    const top = () => frame._fullLayout?._size.t, before = top();
    await Plotly.react(frame, data, layout, settings(data));
    if (before && before !== top()) await Plotly.redraw(frame);  // the legend is where it was for the margin before
  }

  // The range that a vertical axis needs for the points between two times; limits count where they are near.
  function needed(frame, axis, begin, end) {
    const name = axis.replace("axis", "");
    const traces = frame.data.filter((trace) => trace.yaxis === name && trace.visible !== "legendonly");
    const limits = traces.filter((trace) => trace.legendgroup === "limit of the axis").map((trace) => trace.y[0]);
    let low = Infinity, high = -Infinity;
    for (const trace of traces) {
      for (let i = 0; i < trace.x.length; i++) {
        const y = trace.y[i];
        if (y !== null && trace.x[i] >= begin && trace.x[i] <= end) { low = Math.min(low, y); high = Math.max(high, y); }
      }
    }
    if (low > high) return null;
    const span = high - low;
    const near = limits.filter((y) => y > low - span && y < high + span);
    for (const limit of near) {
      low = Math.min(low, limit);
      high = Math.max(high, limit);
    }
    const margin = (near.length ? 0.16 : 0.06) * (high - low) || 0.1 * Math.abs(high) || 1; // with the names of limits
    return [low - margin, high + margin];
  }

  // Show a stretch of time in a chart, and fit its vertical axes, but for those that were zoomed themselves.
  function show(frame, begin, end, own) {
    const change = { "xaxis.range": [begin, end] };
    const [first, last] = frame.layout.meta.span;
    const whole = begin <= first && end >= last;
    for (const axis of frame.layout.meta.rescaled.filter((key) => !own.has(key))) {
      const range = whole ? null : needed(frame, axis, begin, end);
      if (range) change[`${axis}.range`] = range; else change[`${axis}.autorange`] = true;
    }
    return Plotly.relayout(frame, change);
  }

  async function zoomed(frame, change) {
    const keys = Object.keys(change);
    if (busy || !keys.some((key) => key.startsWith("xaxis"))) return;
    busy = true;
    const own = new Set(keys.map((key) => key.split(".")[0]));
    const [begin, end] = change["xaxis.autorange"] ? frame.layout.meta.span : frame.layout.xaxis.range;
    const others = isTimed(frame) ? frames.filter(isTimed) : [frame];
    await Promise.all(others.map((other) => show(other, begin, end, other === frame ? own : new Set())));
    busy = false;
    place();
  }

  // The cursor: a line over each chart over time, moved at most once a picture of the screen.
  let time = null, pointed = null, waiting = false;
  function cursor(at, frame) {
    time = at;
    pointed = frame;
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(place);
  }

  function place() {
    waiting = false;
    for (const frame of frames.filter(isTimed)) {
      const line = frame.querySelector(".cursor") || frame.appendChild(Object.assign(document.createElement("i"), { className: "cursor" }));
      const [begin, end] = frame.layout.xaxis.range;
      const { l, t, w, h } = frame._fullLayout._size;
      line.hidden = time === null || frame === pointed || time < begin || time > end;
      line.style.top = `${t}px`;
      line.style.height = `${h}px`;
      line.style.transform = `translateX(${l + (w * (time - begin)) / (end - begin)}px)`;
    }
  }

  function listen(frame) {
    frame.on("plotly_relayout", (change) => zoomed(frame, change));
    frame.on("plotly_afterplot", place);
    if (!isTimed(frame)) return;
    frame.on("plotly_hover", (event) => {
      const at = event.xvals ? event.xvals[0] : event.points[0].x;
      cursor(at, frame);
      document.dispatchEvent(new CustomEvent("motionsync:time", { detail: { time: at, source: "plots" } }));
    });
  }

  const redraw = () => frames.forEach((frame, i) => draw(frame, texts[i]));
  redraw();
  frames.forEach(listen);
  document.addEventListener("motionsync:time", (event) => {
    if (event.detail.source !== "plots") cursor(event.detail.time, null);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  let resizing;
  addEventListener("resize", () => {
    clearTimeout(resizing);
    resizing = setTimeout(redraw, 100);
  });
  // Paper is light, and narrower than a screen.
  addEventListener("beforeprint", () => { document.documentElement.classList.add("printed"); redraw(); });
  addEventListener("afterprint", () => { document.documentElement.classList.remove("printed"); redraw(); });
})();
