"use strict";
// the answer of a study: means over seeds in a window of time, with their intervals

class Answer {
  constructor(host, choice, study) {
    Object.assign(this, { host, choice, study });
    choice.innerHTML = study.windows.map((window) => `<option>${clean(window)}</option>`).join("");
    choice.value = study.windows.at(-1);
    choice.addEventListener("input", () => this.show());
    const groups = new Set(study.columns.map((column) => column.group));
    host.innerHTML = (study.indices.length ? `<details id="indices" open><summary>What they are sensitive to</summary><div class="wide"></div></details>` : "")
      + [...groups].map((group, n) => `<details data-group="${group}" ${n ? "" : "open"}>
      <summary>${group}</summary><div class="wide"></div></details>`).join("");
    this.show();
  }

  show() {
    for (const box of this.host.children)
      box.lastElementChild.innerHTML = box.dataset.group === undefined ? this.indices()
        : this.table(this.study.columns.filter(({ group }) => group === box.dataset.group));
  }

  // of a sample of Morris or Sobol: a row for each key, a column for each observable
  indices() {
    return this.study.indices.filter(({ window }) => window === this.choice.value).map(({ title, keys, columns, values }) => {
      const rows = keys.map((key, n) => `<tr><td>${clean(key)}</td>${values.length ? values[n].map((value) =>
        `<td class="number">${value.map(short).join(" ± ")}</td>`).join("") : ""}</tr>`);
      return `<table><tr>${[title, ...columns].map((head) => `<th>${symbols(head)}</th>`).join("")}</tr>
        ${rows.join("")}</table>`;
    }).join("");
  }

  // a row for each point; a bar below each mean is its interval, on the scale of its column
  table(columns) {
    const { points } = this.study, means = this.study.means[this.choice.value];
    const shown = columns.filter(({ name }) => means[name].some(([value]) => value !== null));
    const scales = new Map(shown.map(({ name }) => {
      const ends = means[name].flatMap(([value, low, high]) => [value, low, high]).filter((end) => end !== null);
      return [name, [Math.min(...ends), Math.max(...ends)]];
    }));
    const keys = Object.keys(points[0].drawn), word = (value) => (typeof value === "number" ? short(value) : value);
    const rows = points.map((point, n) => `<tr><td>${clean(point.name)}</td>
      ${keys.map((key) => `<td class="number">${clean(word(point.drawn[key]))}</td>`).join("")}<td class="number">${point.done}</td>
      ${shown.map(({ name }) => `<td data-column="${name}">${interval(means[name][n], scales.get(name), point.done)}</td>`).join("")}</tr>`);
    const heads = ["point", ...keys, "seeds", ...shown.map(({ title }) => title)];
    return `<table class="answer"><tr>${heads.map((head) => `<th>${symbols(head)}</th>`).join("")}</tr>${rows.join("")}</table>`;
  }
}

// a mean with its interval; where it is not that of all seeds, of how many
function interval([value, low, high, seeds], [least, greatest], done) {
  if (value === null) return "–";
  const part = seeds < done ? `, ${seeds} of ${done} seeds` : "";
  const share = (end) => (100 * (end - least) / (greatest - least || 1)).toFixed(1);
  const known = low !== null, [from, to] = known ? [low, high] : [value, value];
  return `${short(value)}${known ? ` <span>(${short(low)} to ${short(high)}${part})</span>` : part && `<span>(${part.slice(2)})</span>`}
    <i><u style="left:${share(from)}%;right:${100 - share(to)}%"></u><b style="left:${share(value)}%"></b></i>`;
}

// what was run
function madeOf(study) {
  return `<div><h3>${clean(study.name)}: the file of the study</h3><pre class="scroll">${clean(study.file)}</pre></div>`;
}
