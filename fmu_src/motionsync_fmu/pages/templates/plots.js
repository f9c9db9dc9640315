"use strict";
// Draws the charts of a page: colours of a light or a dark page, one stretch of time and one cursor for all charts.
(() => {
  const frames = [...document.querySelectorAll("div.plot")];
  const texts = frames.map((frame) => frame.nextElementSibling.textContent);
  const config = { displaylogo: false, responsive: true, doubleClick: "reset", modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
  const isTimed = (frame) => frame.layout.meta.timed;
  let busy = false;

  // The figure of a chart; a text that is the name of a CSS property stands for the colour.
  function figure(text) {
    const style = getComputedStyle(document.documentElement);
    return JSON.parse(text, (_, value) =>
      typeof value === "string" && /^--[a-z0-9-]+$/.test(value) ? style.getPropertyValue(value).trim() || value : value);
  }

  // Draw a chart with the colours of now; what is zoomed stays as it is.
  function draw(frame, text) {
    const { data, layout } = figure(text);
    for (const axis of Object.keys(layout).filter((key) => /^[xy]axis/.test(key) && frame.layout)) {
      layout[axis].autorange = frame.layout[axis].autorange;
      layout[axis].range = frame.layout[axis].range;
    }
    if (frame.layout) layout.shapes[0] = { ...layout.shapes[0], x0: frame.layout.shapes[0].x0, x1: frame.layout.shapes[0].x1, visible: frame.layout.shapes[0].visible };
    return Plotly.react(frame, data, layout, config);
  }

  // The range that a vertical axis needs for what is to be seen between two times.
  function needed(frame, axis, begin, end) {
    const name = axis.replace("axis", "");
    let low = Infinity, high = -Infinity;
    for (const trace of frame.data) {
      if (trace.yaxis !== name || trace.visible === "legendonly") continue;
      const outer = trace.x.length === 2;  // a limit: a line through all times
      for (let i = 0; i < trace.x.length; i++) {
        const y = trace.y[i];
        if (y !== null && (outer || (trace.x[i] >= begin && trace.x[i] <= end))) { low = Math.min(low, y); high = Math.max(high, y); }
      }
    }
    if (low > high) return null;
    const room = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  // Show a stretch of time in a chart, and fit its vertical axes, but for those that were zoomed themselves.
  function show(frame, begin, end, zoomed) {
    const change = { "xaxis.range": [begin, end] };
    const [first, last] = frame.layout.meta.span;
    const whole = begin <= first && end >= last;
    for (const axis of frame.layout.meta.rescaled.filter((key) => !zoomed.has(key))) {
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
    await Promise.all(others.map((other) => show(other, begin, end, other === frame && !change["xaxis.autorange"] ? own : new Set())));
    busy = false;
  }

  // The cursor: a line in every chart over time, moved at most once a picture of the screen.
  let wanted = null;
  function cursor(time, without) {
    const waiting = wanted !== null;
    wanted = { time, without };
    if (waiting) return;
    requestAnimationFrame(() => {
      const { time, without } = wanted;
      wanted = null;
      for (const frame of frames.filter(isTimed)) {
        Plotly.relayout(frame, { "shapes[0].x0": time, "shapes[0].x1": time, "shapes[0].visible": frame !== without });
      }
    });
  }

  function listen(frame) {
    frame.on("plotly_relayout", (change) => zoomed(frame, change));
    if (!isTimed(frame)) return;
    frame.on("plotly_hover", (event) => {
      const time = event.xvals ? event.xvals[0] : event.points[0].x;
      cursor(time, frame);
      document.dispatchEvent(new CustomEvent("motionsync:time", { detail: { time, source: "plots" } }));
    });
  }

  const redraw = () => frames.forEach((frame, i) => draw(frame, texts[i]));
  redraw();
  frames.forEach(listen);
  document.addEventListener("motionsync:time", (event) => {
    if (event.detail.source !== "plots") cursor(event.detail.time, null);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  // Paper is light.
  addEventListener("beforeprint", () => { document.documentElement.classList.add("printed"); redraw(); });
  addEventListener("afterprint", () => { document.documentElement.classList.remove("printed"); redraw(); });
})();
