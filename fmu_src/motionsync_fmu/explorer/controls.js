"use strict";
// What can be moved on the page: one control for a value, with a slider where that is a number.

const $ = (id) => document.getElementById(id);
const GRADES = 500; // of a slider, about
const WIDE = 1000; // a declared range up to this is a slider's own range

/** A new element; names with a dash are attributes, the others properties. */
function newElement(tag, values = {}, ...parts) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(values)) {
    if (name.includes("-")) node.setAttribute(name, value);
    else node[name] = value;
  }
  node.append(...parts);
  return node;
}

/** The largest of 1, 2, 5, 10, 20, ... that is not above x, for all powers of ten. */
function round(x) {
  const power = 10 ** Math.floor(Math.log10(x) + 1e-9);
  return power * [5, 2, 1].find((factor) => factor * power <= x * (1 + 1e-9));
}

/**
 * The range and the step of a slider: the declared range where it is narrow; else from 0 to two and a half times
 * the value; of a value 0 as far as `usual` to both sides. It never leaves the declared range, or goes above `reach`.
 */
function sliderRange({min = -Infinity, max = Infinity, reach = Infinity, kind}, x, usual) {
  const most = Math.min(max, reach), narrow = most - min <= WIDE, far = Math.abs(x) * 2.5 || usual;
  const low = narrow ? min : Math.max(x > 0 ? 0 : -far, min), high = narrow ? most : Math.min(x < 0 ? 0 : far, most);
  const step = kind === "Real" ? round((high - low) / GRADES) : 1;
  return {min: step * Math.ceil(low / step - 1e-9), max: high, step};
}

/**
 * A control of a value in `values[name]`.
 *
 * `about`: what is known of it: `label`, `moment` (of a value that is set during the run), `description`, `kind`, `choices`,
 * `unit`, `range`, `min`, `max`, `reach`; `first`: the value that it had; `usual`: see sliderRange, 0 for no slider; `changed`: called with each new value, and when what is in a
 * field is refused. A value of the block is refused by the block; any other number has to be above `above`, and from `min` to
 * `max` if `strict`; 0, or at least `smallest`, if that is given.
 */
function control(about, values, name, {first, usual, changed}) {
  const called = about.label ?? name, label = [called, about.moment].filter(Boolean).join(" ");
  const text = newElement("span", {className: "name"}, ...breakable(called), newElement("span", {className: "soft"}, about.moment ? ` ${about.moment}` : ""));
  const row = newElement("div", {className: "knob", "data-name": called, title: [about.description, about.range].filter(Boolean).join("\n")});
  const show = () => row.classList.toggle("moved", values[name] !== first);
  const put = (x) => {
    values[name] = x;
    show();
    changed(x);
  };
  if (about.kind === "Boolean") row.append(text, tick(label, values[name], put));
  else if (about.choices?.length) row.append(text, choice(label, about.choices, values[name], put));
  else row.append(text, ...number(about, label, {value: values[name], first, usual, put, changed}));
  show();
  return row;
}

/** A name that may be broken after its dots and underscores. */
function breakable(name) {
  return name.split(/(?<=[._])/).flatMap((part) => [part, newElement("wbr")]);
}

function tick(label, value, put) {
  const box = newElement("input", {type: "checkbox", checked: value !== 0, "aria-label": label});
  box.oninput = () => put(box.checked ? 1 : 0);
  return box;
}

function choice(label, choices, value, put) {
  const options = choices.map(([n, text, meaning]) =>
    newElement("option", {value: n, title: meaning, selected: n === value}, text),
  );
  const select = newElement("select", {"aria-label": label}, ...options);
  select.oninput = () => put(Number(select.value));
  return select;
}

/** Refuse what is in a field, with a reason; "": accept it. */
const refuse = (field, reason) => field.setCustomValidity(reason);

/** Why a text is not accepted as a number; "": it is. */
function reasonAgainst({above = -Infinity, min = -Infinity, max = Infinity, smallest = 0, strict}, label, text) {
  const x = Number(text), isOutside = x < min || x > max || (x > 0 && x < smallest), allowed = [];
  if (text === "" || !Number.isFinite(x)) return `${label} = ${text || "nothing"} is not allowed: it must be a number`;
  if (!(x <= above) && !(strict && isOutside)) return "";
  if (above > -Infinity) allowed.push(`> ${above}`);
  if (strict && min > -Infinity) allowed.push(smallest ? `0, or >= ${smallest}` : `>= ${min}`);
  if (strict && max < Infinity) allowed.push(`<= ${max}`);
  return `${label} = ${x} is not allowed: it must be ${allowed.join(" and ")}`;
}

function number(about, label, {value, first, usual, put, changed}) {
  const field = newElement("input", {type: "number", step: "any", value, "aria-label": label});
  const parts = [newElement("span", {}, field, newElement("span", {className: "unit"}, about.unit ?? ""))];
  let line = null;
  if (usual) {
    const range = sliderRange(about, first, usual);
    line = newElement("input", {type: "range", ...range, "aria-label": `${label}, slider`});
    line.value = value;
    line.oninput = () => {
      field.value = Number(Number(line.value).toPrecision(9));
      refuse(field, "");
      put(Number(field.value));
    };
    parts.push(line);
  }
  field.oninput = () => {
    refuse(field, reasonAgainst(about, label, field.value));
    if (!field.validity.valid) {
      changed();
      return;
    }
    if (line) line.value = field.value;
    put(Number(field.value));
  };
  return parts;
}

/** A part of the page that opens and closes; it is left out without rows. */
function group(title, rows, open = true) {
  return rows.length ? [newElement("details", {open}, newElement("summary", {}, title), ...rows)] : [];
}
