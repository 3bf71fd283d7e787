"use strict";
// curves of all statistics, of runs or of the points of a study, with a line at the time that is shown

const CHART = { width: 260, height: 104, left: 4, right: 4, top: 6, bottom: 6 };
const OPEN = ["Cells", "Basal layer", "Order parameters"]; // groups that are open at first
const BEYOND = 1; // how far bands reach beyond all lines at most, of the extent of the lines
const MOST_VALUES = 4; // curves whose values stand above a chart

const LINES = SETTINGS.scales.curves;
const colourOf = (n) => LINES[n % LINES.length];
const strokeOf = (n) => `stroke="${colourOf(n)}"${n < LINES.length ? "" : ' stroke-dasharray="5 2"'}`;

// least and greatest of what is known
function endsOf(values) {
  const known = values.filter((value) => value !== null);
  return known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
}

class Charts {
  // curves: each has a name, times from and to, columns, a table, and perhaps low and high
  constructor(host, curves, onTime, hidden = new Set()) {
    Object.assign(this, { curves, onTime, charts: [] });
    this.shown = curves.map((_, n) => n).filter((n) => !hidden.has(n));
    this.from = Math.min(...curves.map((curve) => curve.from));
    this.to = Math.max(...curves.map((curve) => curve.to));
    const columns = new Map(curves.flatMap((curve) => curve.columns.map((column) => [column.name, column])));
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
      const absent = members.filter((column) => !shown.includes(column)).map((column) => column.title);
      if (absent.length) box.insertAdjacentHTML("beforeend", `<p class="hint">Nowhere defined: ${absent.map(symbols).join("; ")}.</p>`);
      host.append(box);
    }
  }

  values(name, part = "table") { return this.shown.map((n) => this.curves[n][part]?.[name] ?? [null]); }

  x(time) {
    const { width, left, right } = CHART;
    return left + (width - left - right) * (time - this.from) / (this.to - this.from || 1);
  }

  add(host, column) {
    const { width, height, top, bottom } = CHART;
    const all = this.values(column.name), lows = this.values(column.name, "low"), highs = this.values(column.name, "high");
    let [low, high] = endsOf(all.flat());
    const [least, greatest] = [low, high], [lowest, highest] = endsOf([...lows.flat(), ...highs.flat()]);
    const room = BEYOND * (high - low); // wider bands leave the chart, which is then said below it
    [low, high] = [Math.max(Math.min(low, lowest), low - room), Math.min(Math.max(high, highest), high + room)];
    const cut = lowest < low || highest > high ? `; intervals reach from ${short(lowest)} to ${short(highest)}` : "";
    if (low > 0 && low < 0.5 * high) low = 0;
    if (low === high) [low, high] = [low - 1, high + 1];
    const y = (value) => top + (height - top - bottom) * (high - value) / (high - low);
    const lines = all.map((values, place) => {
      const n = this.shown[place], times = this.curves[n].table.time;
      const point = (value, frame) => `${this.x(times[frame]).toFixed(1)},${y(value).toFixed(1)}`;
      let path = "", pen = "M";
      values.forEach((value, frame) => {
        if (value === null) { pen = "M"; return; }
        path += pen + point(value, frame);
        pen = "L";
      });
      return `${this.band(lows[place], highs[place], point, n)}<path d="${path}" fill="none" ${strokeOf(n)} stroke-width="1.6" stroke-linejoin="round"/>`;
    });
    const zero = low < 0 && high > 0 ? `<line x1="0" x2="${width}" y1="${y(0)}" y2="${y(0)}" stroke="#c4cad4"/>` : "";
    const figure = document.createElement("figure");
    figure.dataset.column = column.name;
    figure.innerHTML = `<figcaption><span>${symbols(column.title)}</span><b></b></figcaption>
      <svg viewBox="0 0 ${width} ${height}" preserveAspectRatio="none"><rect width="${width}" height="${height}" fill="#f3f5f8"/>
      ${zero}${lines.join("")}<line class="now" y1="0" y2="${height}" stroke="#d55e00" stroke-width="1.5"/></svg>
      <div class="hint">range ${short(least)} to ${short(greatest)}${cut}${this.mean(column.name)}</div>`;
    const picture = figure.querySelector("svg");
    picture.addEventListener("click", (event) => {
      const box = picture.getBoundingClientRect();
      this.onTime(this.from + (this.to - this.from) * (event.clientX - box.left) / box.width);
    });
    host.append(figure);
    this.charts.push({ name: column.name, now: figure.querySelector(".now"), value: figure.querySelector("b") });
  }

  // the intervals of a curve, in pieces where they are known
  band(lows, highs, point, n) {
    let path = "", piece = [];
    const close = () => {
      if (piece.length > 1)
        path += `M${piece.map((f) => point(highs[f], f)).join("L")}L${piece.reverse().map((f) => point(lows[f], f)).join("L")}Z`;
      piece = [];
    };
    lows.forEach((low, frame) => (low === null ? close() : piece.push(frame)));
    close();
    return path && `<path class="band" d="${path}" fill="${colourOf(n)}" fill-opacity="0.18"/>`;
  }

  // what the mean over the late times is, with its interval
  mean(name) {
    return this.shown.map((n) => {
      const means = this.curves[n].means, mean = means?.means[name];
      if (!mean || mean.value === null) return "";
      const interval = mean.low === null ? "" : ` (${short(mean.low)} to ${short(mean.high)})`;
      const colour = this.curves.length > 1 ? colourOf(n) : "inherit";
      return `<br><span style="color:${colour}">mean from t = ${short(means.start)} on: ${short(mean.value)}${interval}</span>`;
    }).join("");
  }

  show(time) {
    const x = this.x(time);
    for (const { name, now, value } of this.charts) {
      now.setAttribute("x1", x);
      now.setAttribute("x2", x);
      value.innerHTML = this.shown.length > MOST_VALUES ? "" : this.shown.map((n) => {
        const { table } = this.curves[n], times = table.time;
        let best = 0;
        for (let n = 0; n < times.length; n++) if (Math.abs(times[n] - time) < Math.abs(times[best] - time)) best = n;
        const now = short((table[name] ?? [null])[best] ?? null);
        return this.curves.length > 1 ? `<span style="color:${colourOf(n)}">${now}</span>` : now;
      }).join(" | ");
    }
  }
}

// the names of curves, each with a box that hides it
function legendOfCurves(host, curves, changed) {
  const dashes = (n) => (n < LINES.length ? "solid" : "dashed");
  host.innerHTML = curves.length < 2 ? "" : curves.map((curve, n) =>
    `<label class="check"><input type="checkbox" value="${n}" checked>
     <span class="line" style="border-top:3px ${dashes(n)} ${colourOf(n)}"></span>${clean(curve.name)}</label>`).join("");
  host.oninput = () => changed(new Set([...host.querySelectorAll("input:not(:checked)")].map((box) => Number(box.value))));
}
