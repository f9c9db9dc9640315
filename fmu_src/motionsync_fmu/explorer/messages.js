"use strict";
// What a run says in words: what is lit at a time, and a list of what was logged and of the warnings.

const LINES = 100; // of the list, at most
const WORDS = ["", "warning", "discarded", "error"]; // by status

/** The Booleans of which the block's WARNING is true while one of them is. */
function warningsOf(block) {
  const any = block.roles.WARNING, group = any?.slice(0, any.lastIndexOf(".") + 1);
  return any ? block.variables.filter((v) => v.kind === "Boolean" && v.name !== any && v.name.startsWith(group)) : [];
}

/** The counters of cuts that were not made where they were due. */
function missesOf(block) {
  const {skipped, late} = block.piece_variables ?? {};
  return block.variables.filter((v) => v.name === skipped || v.name === late);
}

/** What is lit at the k-th point: the block's Booleans, with the warnings that are present, and counts of missed cuts. */
function lamps(course, block, k) {
  const lit = (v) => course.value(v.name, k) !== 0, any = block.roles.WARNING;
  const own = block.variables.filter(
    (v) => v.start === undefined && v.kind === "Boolean" && (!v.name.includes(".") || v.name === any),
  );
  const lamp = (v, className, ...parts) => newElement("span", {title: v.description, className}, ...parts);
  const flags = own.map((v) => {
    if (!lit(v)) return lamp(v, "off", v.name);
    const causes = v.name === any ? warningsOf(block).filter(lit).map(({name}) => name.slice(any.lastIndexOf(".") + 1)) : [];
    return lamp(v, causes.length ? "warned" : "", newElement("b", {}, v.name), ...(causes.length ? [`: ${causes.join(", ")}`] : []));
  });
  const counts = missesOf(block).map((v) => lamp(v, lit(v) ? "warned" : "off", `${v.name} `, newElement("b", {}, String(course.value(v.name, k)))));
  return [...flags, ...counts];
}

/** What was logged in a run, each warning that was present in it, and cuts that it missed: times, statuses and texts. */
function messagesOf(course, block) {
  const warnings = warningsOf(block).flatMap((v) => {
    const ranges = intervals(course.column(v.name)), often = ranges.length > 1 ? `, ${ranges.length} times` : "";
    return ranges.length ? [{t: course.time[ranges[0][0]], status: 1, text: `${v.name}: ${v.description}${often}`}] : [];
  });
  const misses = missesOf(block).flatMap((v) => {
    const counts = course.column(v.name), first = counts.findIndex((count) => count > 0);
    return first < 0 ? [] : [{t: course.time[first], status: 1, text: `${v.name}: ${v.description}: ${greatest(counts)} in all`}];
  });
  return [...course.lines, ...warnings, ...misses].sort((a, b) => a.t - b.t);
}

/** The list on the page; `none`: the text in place of an empty one; `chosen(t)` is called with the time of a line. */
function listOf(messages, none, chosen) {
  const lines = messages.slice(0, LINES).map(({t, status, text}) => {
    const className = status > 1 ? "bad" : "";
    const line = newElement("button", {type: "button", className}, `${seconds(t)}  ${WORDS[status]}: ${text}`);
    line.onclick = () => chosen(t);
    return line;
  });
  const soft = (text) => [newElement("p", {className: "soft"}, text)];
  if (!lines.length) return soft(none);
  return [...lines, ...(messages.length > LINES ? soft(`and ${messages.length - LINES} more`) : [])];
}

const seconds = (t) => `${t.toFixed(3)} s`;
