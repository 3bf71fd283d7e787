"use strict";
// what is told in words: events, the history of a cell, the scene

const LATEST = 12; // events that are listed
// a number of things, whose word is given in the singular
const counted = (number, what) => `${number.toLocaleString("en")} ${what}${number === 1 ? "" : "s"}`;

// words whose symbols, such as χ_H and R_c, get their indices
const symbols = (text) => clean(text).replace(/([χR])_(\w)\b/g, "$1<sub>$2</sub>");
const clean = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

function table(heads, rows, numbers = []) {
  const cell = (value, n) => `<td${numbers.includes(n) ? ' class="number"' : ""}>${clean(value)}</td>`;
  const head = heads.length ? `<tr>${heads.map((word) => `<th>${clean(word)}</th>`).join("")}</tr>` : "";
  return `<table>${head}${rows.map((row) => `<tr${row.given ? ' class="given"' : ""}>${row.map(cell).join("")}</tr>`).join("")}</table>`;
}

const kindName = (run, number) => run.kinds.get(number)?.name ?? "";

// one row of events.csv in words, as it concerns a cell
function inWords(run, n, id) {
  const { event_kind, event_id, event_parent, event_cause } = run.arrays;
  const kind = run.told.event_names.kind[event_kind[n]], cause = run.told.event_names.cause[event_cause[n]];
  const [cell, other] = [event_id[n], event_parent[n]];
  const about = id === cell ? "" : `${cell} `;
  if (kind === "birth") return id === other ? `gave birth to ${cell}` : `${about}was born of ${other}`;
  if (kind === "division_end") return `division of ${other} and ${cell} ended`;
  if (kind === "death") return `${about}was removed: ${cause}`;
  if (kind === "removal") return `${about}was removed by ${cause}`;
  if (kind === "conversion") return `${about}was converted by ${cause}`;
  if (kind === "addition") return `${about}was added by ${cause}`;
  return `${kind}: ${cause}`;
}

function rowsOf(run, numbers, id) {
  const { event_time, event_type, event_left } = run.arrays;
  return numbers.map((n) => [event_time[n].toFixed(3), inWords(run, n, id), kindName(run, event_type[n]), event_left[n]]);
}

// the cell of a number at a frame, and all that the event log has of it
function history(run, frame, id, onlyRun) {
  const { arrays } = run;
  let here = -1;
  for (let n = run.start[frame]; n < run.start[frame + 1]; n++) if (arrays.cell_id[n] === id) here = n;
  const where = onlyRun ? "" : ` in ${clean(run.told.name)}`;
  const facts = [];
  if (here >= 0) {
    const age = arrays.cell_age[here], kind = run.kinds.get(arrays.cell_kind[here]);
    facts.push(["kind", kind.name], ["clone of cell", arrays.cell_clone[here]],
      ["age", Number.isNaN(age) ? "there from the start" : short(age)],
      ["generations left", kind.endless ? "without end" : arrays.cell_left[here]],
      ["cells straight below", arrays.cell_below[here]],
      ["mean curvature below", short(arrays.cell_curvature[here])], ["height", short(run.cell(here)[2])]);
  }
  const state = here >= 0 ? table([], facts)
    : `<p>At t = ${short(run.told.frames[frame])} this cell is not there.</p>`;
  if (!arrays.event_id) return `<h3>Cell ${id}${where}</h3>${state}<p>There is no event log.</p>`;
  const numbers = [], mother = new Map();
  const births = run.told.event_names.kind.indexOf("birth");
  for (let n = 0; n < arrays.event_id.length; n++) {
    if (arrays.event_id[n] === id || arrays.event_parent[n] === id) numbers.push(n);
    if (arrays.event_kind[n] === births) mother.set(arrays.event_id[n], arrays.event_parent[n]);
  }
  const line = [id];
  while (mother.has(line.at(-1))) line.push(mother.get(line.at(-1)));
  const descent = line.length > 1 ? `descends from ${line.slice(1).join(", ")}` : "was not born in this run";
  return `<h3>Cell ${id}${where}: ${descent}</h3><div class="beside"><div>${state}</div>
    <div class="scroll" data-history="${id}">${numbers.length
      ? table(["time", "event", "kind", "generations left"], rowsOf(run, numbers, id), [0, 3])
      : "<p>The event log has nothing of it.</p>"}</div></div>`;
}

// what has happened in all, and the latest events before a time
function events(run, time) {
  const found = run.told.events, times = run.arrays.event_time;
  if (!found) return `<div><h3>${clean(run.told.name)}</h3><p>There is no event log.</p></div>`;
  const counts = [["births", found.births.toLocaleString("en")],
    ...Object.entries(found.removals_by_cause).map(([cause, n]) => [`removed: ${cause}`, n.toLocaleString("en")]),
    ...Object.entries(found.interventions)];
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1; else high = middle;
  }
  const latest = [];
  for (let n = low - 1; n >= Math.max(low - LATEST, 0); n--) latest.push(n);
  return `<div><h3>${clean(run.told.name)}: in the whole run</h3>${table([], counts, [1])}</div>
    <div><h3>the latest up to t = ${short(time)}</h3>
    ${table(["time", "event", "kind", "generations left"], rowsOf(run, latest), [0, 3])}</div>`;
}

// what was run, in a line
function leadOf(runs, study) {
  if (study) {
    const { points, scene, parameters } = study, all = points.reduce((sum, point) => sum + point.runs, 0);
    return `${scene}, parameters ${parameters}: ${counted(points.length, "point")}, ${counted(all, "run")}`;
  }
  return runs.map(({ told }) => `${runs.length > 1 ? `${told.name}: ` : ""}${told.description || told.scene}, `
    + `parameters ${told.parameters}, t = ${short(told.from)} to ${short(told.to)}`).join(" | ");
}

// warnings and what was left out; those of runs of a study stand below each other, folded
function warningsOf(runs, study) {
  const several = study || runs.length > 1;
  const line = (told, text, style) => `<li class="${style}">${told && several ? `${clean(told.name)}: ` : ""}${clean(text)}</li>`;
  const ofRuns = runs.flatMap(({ told }) => [
    ...told.warnings.map((text) => line(told, text, "")),
    ...(told.thinned ? [line(told, told.thinned, "plain")] : []),
  ]).join("");
  if (!study) return ofRuns;
  return [...study.warnings.map((text) => line(null, text, "")), ...study.remarks.map((text) => line(null, text, "plain")),
    ofRuns && `<li class="plain"><details><summary>Of the runs that are drawn</summary><ul class="warnings">${ofRuns}</ul></details></li>`].join("");
}

// scene, parameters and provenance
function made(run) {
  const { told } = run;
  const keys = told.keys.map(([key, value, given]) => Object.assign([key, value], { given }));
  return `<div><h3>${clean(told.name)}: scene ${clean(told.scene)}</h3><p>${clean(told.description)}</p>
    ${table([], Object.entries(told.provenance))}
    <details><summary>All parameters (set ${clean(told.parameters)}; what the scene itself gives is bold)</summary>
    <div class="scroll">${table([], keys)}</div></details></div>`;
}
