"use strict";
// What is set on the page, in its address behind the #: the scenario, and by its place what differs from it, as
// `run=basic_cut&start/length=1200&settings/1/at=2.5`. The page that is opened with that address shows the same run.

const PART = /^[a-z0-9][\w.]*$/i; // of a place: `__proto__` is none

/** All that is in a value, by its place; of a list also its length. */
function leaves(value, place = []) {
  if (value === null || typeof value !== "object") return [[place.join("/"), value]];
  const parts = Object.entries(value).flatMap(([name, part]) => leaves(part, [...place, name]));
  return Array.isArray(value) ? [...parts, [[...place, "length"].join("/"), value.length]] : parts;
}

/** What makes `changed` of `original`: places with what is there, undefined for what is there no longer. */
function differences(original, changed) {
  const before = new Map(leaves(original)), after = new Map(leaves(changed));
  const gone = [...before.keys()].filter((place) => !after.has(place)).map((place) => [place, undefined]);
  return [...gone, ...[...after].filter(([place, x]) => !before.has(place) || !Object.is(before.get(place), x))];
}

/** Put what is at a place into `target`; undefined: take it away.
 *
 * Throws: an Error, if there can be no such place.
 */
function put(target, place, x) {
  const parts = place.split("/"), name = parts.pop();
  if (![...parts, name].every((part) => PART.test(part))) throw new Error(`the address has the place ${place}, which there is not`);
  let inner = target;
  parts.forEach((part, i) => {
    const isThere = Object.hasOwn(inner, part) && inner[part] !== null && typeof inner[part] === "object";
    if (!isThere && x !== undefined) inner[part] = /^\d+$/.test(parts[i + 1] ?? name) ? [] : {};
    inner = isThere || x !== undefined ? inner[part] : {};
  });
  if (x === undefined) delete inner[name];
  else inner[name] = x;
}

/** A number, null, or a text, as the address has it; nothing where there is no value. */
const inAddress = (x) => (x === undefined ? "" : Object.is(x, -0) ? "-0" : encodeURIComponent(String(x)));

function fromAddress(text) {
  if (text === "") return undefined;
  if (text === "null") return null;
  return Number.isNaN(Number(text)) ? text : Number(text);
}

/** Places and values as one text, and back. */
const joined = (pairs) => pairs.map(([place, x]) => `${place}=${inAddress(x)}`).join("&");
