"use strict";
// colours of cells and of the membrane: each a value of a cell, and a scale

const rgb = (hex) => [1, 3, 5].map((n) => parseInt(hex.slice(n, n + 2), 16) / 255);
const SCALES = Object.fromEntries(Object.entries(SETTINGS.scales).map(([name, all]) => [name, all.map(rgb)]));
const UNKNOWN = [0.72, 0.72, 0.72];

function shade(scale, value, low, high) {
  if (Number.isNaN(value)) return UNKNOWN;
  const colours = SCALES[scale], share = (value - low) / (high - low || 1);
  return colours[Math.round(Math.min(Math.max(share, 0), 1) * (colours.length - 1))];
}

const CELL_COLOURS = {
  kind: { title: "kind", of: (run, n) => rgb(run.kinds.get(run.arrays.cell_kind[n]).colour) },
  height: {
    title: "height", scale: "height", ends: (run) => run.told.ranges.cells.height,
    value: (run, n) => run.length(run.arrays.cells, n, 2),
  },
  curvature: {
    title: "mean curvature below", scale: "curvature",
    ends: (run) => [-run.told.ranges.cells.curvature, run.told.ranges.cells.curvature],
    value: (run, n) => run.arrays.cell_curvature[n],
  },
  clone: {
    title: "clone", note: (run) => `${counted(run.clones.size, "clone")}, each in a colour of ${SCALES.clones.length}`,
    of: (run, n) => SCALES.clones[run.clones.get(run.arrays.cell_clone[n])],
  },
  age: {
    title: "age (time units)", scale: "age", ends: (run) => [0, run.told.ranges.cells.age],
    value: (run, n) => run.arrays.cell_age[n], unknown: "there from the start",
  },
  left: {
    title: "generations left", scale: "generations", ends: (run) => [0, run.most.left],
    value: (run, n) => run.kinds.get(run.arrays.cell_kind[n]).endless ? NaN : run.arrays.cell_left[n],
    unknown: "divides without end",
  },
  below: {
    title: "cells straight below", scale: "below", ends: (run) => [0, run.most.below],
    value: (run, n) => run.arrays.cell_below[n],
  },
};
for (const colour of Object.values(CELL_COLOURS))
  colour.of ??= (run, n) => shade(colour.scale, colour.value(run, n), ...colour.ends(run));

const MEMBRANE_COLOURS = {
  plain: { title: "plain", of: (run) => rgb(run.told.membrane) },
  height: {
    title: "height", scale: "height", ends: (run) => run.told.ranges.height,
    of: (run, frame, n) => shade("height", run.point(frame, n, 2), ...run.told.ranges.height),
  },
  curvature: {
    title: "mean curvature", scale: "curvature",
    ends: (run) => [-run.told.ranges.curvature, run.told.ranges.curvature],
    of: (run, frame, n) => shade("curvature", run.arrays.curvature[frame * run.points + n], 0, 255),
  },
};

const css = (colour) => `rgb(${colour.map((part) => Math.round(255 * part)).join()})`;

// the legend of a colouring, with the ends of its scale in each run
function legendOf(colour, runs) {
  if (colour.note) return runs.map(colour.note).join("<br>");
  if (!colour.scale) return "";
  const shades = SCALES[colour.scale].map(css).join();
  const ends = runs.map((run) => colour.ends(run).map(short));
  const lines = [...new Set(ends.map(([low, high]) => `<div class="ends"><span>${low}</span><span>${high}</span></div>`))];
  const unknown = colour.unknown ? `<span class="swatch" style="background:${css(UNKNOWN)}"></span>${colour.unknown}` : "";
  return `<div class="shades" style="background:linear-gradient(90deg,${shades})"></div>${lines.join("")}${unknown}`;
}

// a number in three digits
function short(value) {
  if (value === null || Number.isNaN(value)) return "–";
  return Number.isInteger(value) || Math.abs(value) >= 1000 ? Math.round(value).toLocaleString("en")
    : String(Number(value.toPrecision(3)));
}
