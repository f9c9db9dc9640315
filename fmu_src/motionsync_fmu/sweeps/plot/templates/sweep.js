"use strict";
// Paints the map of a sweep, and shows the runs of the cell or point that is chosen by pointer or keys.
(() => {
  const data = JSON.parse(document.getElementById("sweep").textContent);
  const frames = [...document.querySelectorAll("div.plot")];
  const panel = document.querySelector(".picked");
  const hint = panel.innerHTML;
  const TYPES = { u2: Uint16Array, u4: Uint32Array, f4: Float32Array, f8: Float64Array };

  function unpacked({ kind, bytes }) {
    return new TYPES[kind](Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0)).buffer);
  }

  // A column of the runs: a function from a run's place to its value; null: not known.
  function column(values) {
    if (values.data) {
      const all = unpacked(values.data);
      return (place) => (Number.isFinite(all[place]) ? all[place] : null);
    }
    const places = unpacked(values.places);
    return (place) => values.list[places[place]];
  }

  const runs = { numbers: column(data.runs.numbers), columns: data.runs.columns.map((c) => ({ ...c, at: column(c.values) })) };
  const map = data.map && {
    ...data.map,
    ...Object.fromEntries(["cx", "cy", "runs", "pick", "least", "greatest"].map((key) => [key, data.map[key] && unpacked(data.map[key])])),
  };
  if (map) {
    const texts = data.map.value.places;
    const places = unpacked(texts || data.map.value);
    map.value = texts ? Array.from(places, (place) => data.map.value.list[place]) : places;
    map.x = data.x;
    map.rows = map.y.edges.length - 1;
    map.cellIndex = new Map(Array.from(map.cx, (cx, i) => [cx * map.rows + map.cy[i], i]));
  }

  // Numbers for people have seven digits; those of a command have all, so that they are read as the same bits.
  const short = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(7))) : "no value");
  const whole = (value) => (Object.is(value, -0) ? "-0.0" : String(value));
  const grouped = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");
  const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);
  const percent = (share) => `${Number((100 * share).toPrecision(4))} %`;
  const quoted = (text) => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", `'"'"'`)}'`);

  function command(place) {
    const given = runs.columns.filter((c) => c.varied && c.at(place) !== null);
    const settings = given.map((c) => `--set ${quoted(`${c.name}=${c.kind === "number" ? whole(c.at(place)) : c.at(place)}`)}`);
    return [data.command, ...settings].join(" ");
  }

  // The map: a picture in the chart's own coordinates, painted again whenever the chart is drawn with other colours.
  const rgb = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));

  function between(scale, share) {
    const i = Math.max(1, scale.findIndex(([stop]) => stop >= share));
    const [[low, from], [high, to]] = [scale[i - 1], scale[i]];
    const part = (share - low) / (high - low);
    const [a, b] = [rgb(from), rgb(to)];
    return `rgb(${a.map((c, k) => Math.round(c + part * (b[k] - c))).join(",")})`;
  }

  function colour(look, value) {
    if (look.texts) {
      if (!value) return look.none;
      const place = data.paint.texts.indexOf(value);
      return place < 0 ? look.other : look.texts[place];
    }
    if (!Number.isFinite(value)) return look.none;
    const { low, high, logarithmic } = data.paint;
    const [v, a, b] = logarithmic ? [value, low, high].map(Math.log10) : [value, low, high];
    return between(look.scale, Math.min(1, Math.max(0, (v - a) / (b - a))));
  }

  const WIDE = 1920, TALL = 1200;  // pixels of the picture
  function painted(look) {
    const canvas = Object.assign(document.createElement("canvas"), { width: WIDE, height: TALL });
    const pen = canvas.getContext("2d");
    const place = (edges, size) => edges.map((e) => Math.round((size * (e - edges[0])) / (edges.at(-1) - edges[0])));
    const xs = place(map.x.edges, WIDE), ys = place(map.y.edges, TALL);
    for (let i = 0; i < map.cx.length; i++) {
      const [x, y] = [map.cx[i], map.cy[i]];
      pen.fillStyle = colour(look, map.value[i]);
      pen.fillRect(xs[x], TALL - ys[y + 1], xs[x + 1] - xs[x], ys[y + 1] - ys[y]);
    }
    return canvas.toDataURL();
  }

  function paint(frame) {
    if (frame.layout.images?.length) return;
    const [x, y] = [map.x.edges, map.y.edges];
    const image = {
      source: painted(frame.layout.meta), xref: "x", yref: "y", x: x[0], y: y.at(-1), sizex: x.at(-1) - x[0], sizey: y.at(-1) - y[0],
      sizing: "stretch", layer: "below",
    };
    Plotly.relayout(frame, { images: [image] });
  }

  // Where values of a chart are in its frame, in px, and back.
  function scales(frame) {
    const { l, t, w, h } = frame._fullLayout._size;
    const [x0, x1] = frame._fullLayout.xaxis.range, [y0, y1] = frame._fullLayout.yaxis.range;
    const logarithmic = frame._fullLayout.yaxis.type === "log";
    return {
      left: l, top: t, width: w, height: h,
      px: (x) => l + (w * (x - x0)) / (x1 - x0),
      py: (y) => t + (h * (y1 - (logarithmic ? Math.log10(y) : y))) / (y1 - y0),
      x: (px) => x0 + ((x1 - x0) * (px - l)) / w,
      y: (py) => y1 - ((y1 - y0) * (py - t)) / h,
    };
  }

  function cellAt(edges, value) {
    if (!(value >= edges[0] && value <= edges.at(-1))) return -1;
    let low = 0, high = edges.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (edges[middle] <= value) low = middle; else high = middle;
    }
    return low;
  }

  function range(axis, i) {
    if (axis.names.length) return `${axis.name} ${axis.names[i]}`;
    const [low, high] = [axis.low[i], axis.high[i]];
    return `${axis.name} ${withUnit(low === high ? short(low) : `${short(low)} to ${short(high)}`, axis.unit)}`;
  }

  function valueOf(i) {
    const value = map.value[i];
    if (data.statistic.name === "count") return "";
    if (data.statistic.name === "most") return `most frequent ${data.statistic.column}: ${value || "none"}`;
    if (!Number.isFinite(value)) return `no value of ${data.statistic.column}`;
    if (data.statistic.name === "share") return `${percent(value)} ${data.statistic.column === "passed" ? "" : "with "}${data.statistic.column}`;
    const unit = data.statistic.unit;
    const many = map.least[i] === map.greatest[i] ? "" : `, from ${short(map.least[i])} to ${short(map.greatest[i])}`;
    return `${data.statistic.name} of ${data.statistic.column} ${withUnit(short(value), unit)}${many}`;
  }

  const count = (n) => `${grouped(n)} run${n === 1 ? "" : "s"}`;

  // What can be chosen; all have `pick`, the place of the run that stands for it, and where they are in the charts.
  function cell(i) {
    const [cx, cy] = [map.cx[i], map.cy[i]];
    const where = `${range(map.x, cx)}, ${range(map.y, cy)}`;
    const shown = valueOf(i);
    return { key: `cell ${i}`, cx, cy, pick: map.pick[i], text: `${where}: ${count(map.runs[i])}${shown ? `, ${shown}` : ""}` };
  }

  function point(frame, line, i) {
    const trace = frame.data[line];
    const [n, pick] = trace.customdata[i];
    const cx = cellAt(data.x.edges, trace.x[i]);
    const { shows: y, groups } = frame.layout.meta;
    const name = trace.name ? `${groups} ${trace.name}, ` : "";
    const value = trace.y[i] === null ? "no run passed from any value on" : `${y.what}${withUnit(short(trace.y[i]), y.unit)}`;
    return { key: `${line} ${i} ${y.what}`, cx, frame, line, i, pick, text: `${name}${range(data.x, cx)}: ${value} (${count(n)})` };
  }

  function frontPoint(place, i) {
    return { key: `front ${i}`, pick: place, text: "A run of the Pareto front", at: i };
  }

  let chosen = null, held = false;

  function choose(next, hold = false) {
    if (!next || (held && !hold)) return;
    held = hold && !(held && chosen.key === next.key);
    if (chosen && chosen.key === next.key && !hold) return;
    chosen = next;
    notify();
    mark();
  }

  function element(name, text, parent, className = "") {
    const made = parent.appendChild(Object.assign(document.createElement(name), { className, textContent: text }));
    return made;
  }

  function notify() {
    panel.classList.toggle("held", held);
    panel.replaceChildren();
    element("p", chosen.text, panel, "where");
    if (chosen.pick < 0) return;
    const result = (name) => runs.columns.find((c) => c.name === name)?.at(chosen.pick);
    const why = result("refusal") || (data.by_expectations ? result("first_broken") : "");
    const verdict = result("passed") === "true" ? "passed" : result("refusal") ? "was refused" : "did not pass";
    element("p", `Run ${grouped(runs.numbers(chosen.pick))} ${verdict}${why ? `: ${why}` : ""}`, panel, verdict === "passed" ? "good" : "bad");
    const list = element("dl", "", panel);
    for (const c of runs.columns.filter((c) => !["passed", "refusal", "first_broken"].includes(c.name))) {
      const row = element("div", "", list, c.varied ? "varied" : "");
      element("dt", c.name, row);
      const value = c.at(chosen.pick);
      element("dd", c.kind === "number" ? withUnit(value === null ? "none" : short(value), value === null ? "" : c.unit) : value || "none", row);
    }
    const row = element("div", "", panel, "command");
    const code = element("code", command(chosen.pick), row);
    const copy = element("button", "copy", row);
    copy.type = "button";
    copy.addEventListener("click", () => copied(code, copy));
    element("p", held ? "Held: Esc, or the same place again, lets go." : "A click or Enter holds it.", panel, "lead");
  }

  async function copied(code, button) {
    getSelection().selectAllChildren(code);
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = "copied";
    } catch {
      button.textContent = "selected";  // without the right to write, Ctrl+C does
    }
  }

  // The chosen cell is framed in the map, and its column is marked in the other charts.
  function mark() {
    for (const frame of frames) {
      const box = frame.querySelector(".chosen") || frame.appendChild(Object.assign(document.createElement("i"), { className: "chosen" }));
      box.hidden = !chosen || chosen.cx === undefined;
      if (box.hidden) continue;
      const s = scales(frame);
      const inMap = frame.layout.meta.role === "map" && chosen.cy !== undefined;
      const [x0, x1] = [s.px(data.x.edges[chosen.cx]), s.px(data.x.edges[chosen.cx + 1])];
      const [y0, y1] = inMap ? [s.py(map.y.edges[chosen.cy + 1]), s.py(map.y.edges[chosen.cy])] : [s.top, s.top + s.height];
      const left = Math.max(x0, s.left), right = Math.min(x1, s.left + s.width);
      const top = Math.max(y0, s.top), bottom = Math.min(y1, s.top + s.height);
      box.hidden = right <= left || bottom <= top;
      box.classList.toggle("column", !inMap);
      box.style.transform = `translate(${left}px, ${top}px)`;
      box.style.width = `${Math.max(right - left, 5)}px`;
      box.style.height = `${Math.max(bottom - top, 5)}px`;
    }
  }

  // What is under a place of a frame, in px.
  function under(frame, px, py) {
    const s = scales(frame);
    if (px < s.left || px > s.left + s.width || py < s.top || py > s.top + s.height) return null;
    if (frame.layout.meta.role === "map") return underMap(frame, s, px, py);
    const cx = cellAt(data.x.edges, s.x(px));
    let best = null, least = Infinity;
    linesOf(frame).forEach((line) => frame.data[line].x.forEach((x, i) => {
      const y = frame.data[line].y[i];
      const away = y === null ? 1e5 : Math.abs(s.py(y) - py);
      if (cellAt(data.x.edges, x) === cx && away < least) [best, least] = [[line, i], away];
    }));
    return best && point(frame, ...best);
  }

  const NEAR = 10;  // px
  function underMap(frame, s, px, py) {
    const front = frame.data.find((trace) => trace.name === "Pareto front");
    const near = front ? front.x.findIndex((x, i) => Math.hypot(s.px(x) - px, s.py(front.y[i]) - py) < NEAR) : -1;
    if (near >= 0) return frontPoint(front.customdata[near], near);
    const [cx, cy] = [cellAt(map.x.edges, s.x(px)), cellAt(map.y.edges, s.y(py))];
    const i = cx < 0 || cy < 0 ? undefined : map.cellIndex.get(cx * map.rows + cy);
    return i === undefined ? null : cell(i);
  }

  const linesOf = (frame) => frame.data.flatMap((trace, line) => (trace.customdata && trace.visible !== "legendonly" ? [line] : []));

  // The next thing in a direction from the chosen one.
  function moved(frame, dx, dy) {
    if (frame.layout.meta.role === "map") return movedCell(dx, dy);
    const lines = linesOf(frame);
    if (chosen?.frame !== frame) return point(frame, lines[0], 0);
    const line = lines[Math.min(lines.length - 1, Math.max(0, lines.indexOf(chosen.line) - dy))];
    const all = frame.data[line].x;
    const current = frame.data[chosen.line].x[chosen.i];
    const i = all.reduce((best, x, k) => (Math.abs(x - current) < Math.abs(all[best] - current) ? k : best), 0);
    return point(frame, line, Math.min(all.length - 1, Math.max(0, i + dx)));
  }

  function movedCell(dx, dy) {
    if (chosen?.cy === undefined) return cell(map.cx.length >> 1);
    const columns = map.x.edges.length - 1;
    for (let x = chosen.cx + dx, y = chosen.cy + dy; x >= 0 && y >= 0 && x < columns && y < map.rows; x += dx, y += dy) {
      const i = map.cellIndex.get(x * map.rows + y);
      if (i !== undefined) return cell(i);
    }
    return null;
  }

  const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

  function listen(frame) {
    const at = (event) => {
      const box = frame.getBoundingClientRect();
      return under(frame, event.clientX - box.x, event.clientY - box.y);
    };
    let down = null;
    frame.tabIndex = 0;
    frame.setAttribute("role", "application");
    frame.addEventListener("pointermove", (event) => event.buttons || choose(at(event)), true);
    frame.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; }, true);
    addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) choose(at(event), true);
      down = null;
    }, true);
    frame.addEventListener("focus", () => frame.matches(":focus-visible") && !chosen && choose(moved(frame, 0, 0)));
    frame.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && chosen) choose(chosen, true);
      if (!MOVES[event.key]) return;
      event.preventDefault();
      held = false;
      choose(moved(frame, ...MOVES[event.key]));
    });
    frame.on("plotly_afterplot", () => {
      if (map && frame.layout.meta.role === "map") paint(frame);
      mark();
    });
    if (map && frame.layout.meta.role === "map") paint(frame);
  }

  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !chosen) return;
    held = false;
    chosen = null;
    panel.classList.remove("held");
    panel.innerHTML = hint;
    mark();
  });
  document.querySelectorAll("[data-pick]").forEach((button, i) => {
    const next = () => frontPoint(Number(button.dataset.pick), i);
    button.addEventListener("focus", () => choose(next()));
    button.addEventListener("pointerenter", () => choose(next()));
    button.addEventListener("click", () => choose(next(), true));
  });
  frames.forEach(listen);
})();
