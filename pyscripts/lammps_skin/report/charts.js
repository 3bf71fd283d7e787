"use strict";
// curves of all statistics, with a line at the time that is shown

const CHART = { width: 260, height: 104, left: 4, right: 4, top: 6, bottom: 6 };
const OPEN = ["Cells", "Basal layer", "Order parameters"]; // groups that are open at first

const LINES = SETTINGS.scales.runs; // a colour for each run

class Charts {
  constructor(host, runs, onTime) {
    Object.assign(this, { runs, onTime, charts: [] });
    this.from = Math.min(...runs.map((run) => run.told.from));
    this.to = Math.max(...runs.map((run) => run.told.to));
    const columns = new Map(runs.flatMap((run) => run.told.columns.map((column) => [column.name, column])));
    const groups = new Map();
    for (const column of columns.values()) groups.set(column.group, [...(groups.get(column.group) ?? []), column]);
    const opened = new Set([...host.querySelectorAll("details")].filter((one) => one.open).map((one) => one.dataset.group));
    const before = host.childElementCount > 0;
    host.replaceChildren();
    for (const [group, members] of groups) {
      const box = document.createElement("details");
      box.dataset.group = group;
      box.open = before ? opened.has(group) : OPEN.includes(group);
      box.innerHTML = `<summary>${group}</summary><div class="charts"></div>`;
      const shown = members.filter((column) => this.values(column.name).flat().some((value) => value !== null));
      for (const column of shown) this.add(box.lastChild, column);
      const absent = members.filter((column) => !shown.includes(column)).map((column) => column.name);
      if (absent.length) box.insertAdjacentHTML("beforeend", `<p class="hint">Nowhere defined: ${absent.join(", ")}.</p>`);
      host.append(box);
    }
  }

  values(name) { return this.runs.map((run) => run.told.table[name] ?? [null]); }

  x(time) {
    const { width, left, right } = CHART;
    return left + (width - left - right) * (time - this.from) / (this.to - this.from || 1);
  }

  add(host, column) {
    const { width, height, top, bottom } = CHART;
    const all = this.values(column.name), known = all.flat().filter((value) => value !== null);
    let [low, high] = known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
    const [least, greatest] = [low, high];
    if (low > 0 && low < 0.5 * high) low = 0;
    if (low === high) [low, high] = [low - 1, high + 1];
    const y = (value) => top + (height - top - bottom) * (high - value) / (high - low);
    const lines = all.map((values, n) => {
      const times = this.runs[n].told.table.time;
      let path = "", pen = "M";
      values.forEach((value, place) => {
        if (value === null) { pen = "M"; return; }
        path += `${pen}${this.x(times[place]).toFixed(1)},${y(value).toFixed(1)}`;
        pen = "L";
      });
      return `<path d="${path}" fill="none" stroke="${LINES[n]}" stroke-width="1.6" stroke-linejoin="round"/>`;
    });
    const zero = low < 0 && high > 0 ? `<line x1="0" x2="${width}" y1="${y(0)}" y2="${y(0)}" stroke="#c4cad4"/>` : "";
    const figure = document.createElement("figure");
    figure.dataset.column = column.name;
    figure.innerHTML = `<figcaption><span>${column.title}</span><b></b></figcaption>
      <svg viewBox="0 0 ${width} ${height}" preserveAspectRatio="none"><rect width="${width}" height="${height}" fill="#f3f5f8"/>
      ${zero}${lines.join("")}<line class="now" y1="0" y2="${height}" stroke="#d55e00" stroke-width="1.5"/></svg>
      <div class="hint">range ${short(least)} to ${short(greatest)}${this.mean(column.name)}</div>`;
    const picture = figure.querySelector("svg");
    picture.addEventListener("click", (event) => {
      const box = picture.getBoundingClientRect();
      this.onTime(this.from + (this.to - this.from) * (event.clientX - box.left) / box.width);
    });
    host.append(figure);
    this.charts.push({ name: column.name, now: figure.querySelector(".now"), value: figure.querySelector("b") });
  }

  // what the mean over the late times is, with its interval
  mean(name) {
    return this.runs.map((run) => {
      const mean = run.told.means.means[name];
      if (!mean || mean.value === null) return "";
      const interval = mean.low === null ? "" : ` (${short(mean.low)} to ${short(mean.high)})`;
      return `<br>mean from t = ${short(run.told.means.start)} on: ${short(mean.value)}${interval}`;
    }).join("");
  }

  show(time) {
    const x = this.x(time);
    for (const { name, now, value } of this.charts) {
      now.setAttribute("x1", x);
      now.setAttribute("x2", x);
      value.textContent = this.runs.map((run) => {
        const times = run.told.table.time;
        let best = 0;
        for (let n = 0; n < times.length; n++) if (Math.abs(times[n] - time) < Math.abs(times[best] - time)) best = n;
        return short((run.told.table[name] ?? [null])[best] ?? null);
      }).join(" | ");
    }
  }
}
