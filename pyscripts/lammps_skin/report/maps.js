"use strict";
// the plane: heights, clones, and a vertical section

const WIDE = 900; // pixels of a map

class Maps {
  constructor(host, run, name) {
    const captions = {
      heights: "Height of the membrane (dark is low), with the cells that stay on it",
      clones: "Cells from above, each clone in its colour",
      section: `Vertical section: membrane and cells${run.arrays.dermis ? ", and the dermis" : "; the dermis is not drawn"}`,
    };
    if (name) host.insertAdjacentHTML("beforeend", `<h3>${clean(name)}</h3>`);
    const row = document.createElement("div");
    row.className = "maps";
    row.innerHTML = Object.entries(captions).map(([name, caption]) =>
      `<figure><canvas data-map="${name}"></canvas><figcaption>${caption}</figcaption></figure>`).join("");
    host.append(row);
    for (const canvas of row.querySelectorAll("canvas")) this[canvas.dataset.map] = canvas.getContext("2d");
    this.take(run);
  }

  // another run, or the same one grown
  take(run) {
    this.run = run;
    const [x, y] = run.told.box;
    for (const { canvas } of [this.heights, this.clones, this.section]) {
      canvas.width = WIDE;
      canvas.height = Math.round(WIDE * (canvas.dataset.map === "section" ? this.depth : y) / x);
    }
  }

  // from below the membrane to above the cells
  get depth() {
    const { low, high } = this.run.told.ranges;
    return high[2] - low[2] + 2 * this.run.told.radius;
  }

  show(view, y) {
    this.showHeights(view);
    this.showClones(view);
    this.showSection(view, y);
  }

  // circles at places in the plane, and again where they reach over a side
  discs(context, view, fill, keep) {
    const { run } = this, scale = WIDE / run.told.box[0], radius = run.told.radius * scale;
    const [wide, high] = [context.canvas.width, context.canvas.height];
    const order = [];
    for (let n = run.start[view.frame]; n < run.start[view.frame + 1]; n++) if (keep(n)) order.push(n);
    order.sort((a, b) => run.arrays.cells[3 * a + 2] - run.arrays.cells[3 * b + 2]);
    for (const n of order) {
      const [cx, cy] = run.cell(n), [alpha, colour] = fill(n);
      const left = (cx * scale % wide + wide) % wide, top = ((high - cy * scale) % high + high) % high;
      context.globalAlpha = alpha;
      context.fillStyle = css(colour);
      for (const i of [-wide, 0, wide]) for (const j of [-high, 0, high]) {
        if (left + i < -radius || left + i > wide + radius || top + j < -radius || top + j > high + radius) continue;
        context.beginPath();
        context.arc(left + i, top + j, radius, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
    }
    context.globalAlpha = 1;
  }

  showHeights(view) {
    const { run, heights } = this, [columns, rows] = run.told.grid;
    const small = new OffscreenCanvas(columns, rows), picture = new ImageData(columns, rows);
    const from = view.frame * columns * rows;
    for (let i = 0; i < columns; i++) for (let j = 0; j < rows; j++) {
      const colour = shade("height", run.arrays.height[from + i * rows + j], 0, 255);
      picture.data.set([...colour.map((part) => 255 * part), 255], 4 * ((rows - 1 - j) * columns + i));
    }
    small.getContext("2d").putImageData(picture, 0, 0);
    heights.drawImage(small, 0, 0, heights.canvas.width, heights.canvas.height);
    heights.strokeStyle = "black";
    heights.lineWidth = 2;
    const mapped = new Set(run.told.kinds.filter((kind) => kind.on_map).map((kind) => kind.number));
    this.discs(heights, view, (n) => [1, CELL_COLOURS.kind.of(run, n)], (n) => mapped.has(run.arrays.cell_kind[n]));
  }

  showClones(view) {
    const { run, clones } = this;
    clones.clearRect(0, 0, clones.canvas.width, clones.canvas.height);
    clones.strokeStyle = "#0006";
    clones.lineWidth = 1;
    this.discs(clones, view, (n) => {
      const faded = view.clone && run.arrays.cell_clone[n] !== view.clone;
      return [faded ? 0.2 : 1, CELL_COLOURS.clone.of(run, n)];
    }, () => true);
  }

  showSection(view, share) {
    const { run, section } = this, [x, side] = run.told.box, scale = WIDE / x;
    const { low, high } = run.told.ranges, radius = run.told.radius;
    const y = share * side, top = high[2] + radius;
    section.clearRect(0, 0, section.canvas.width, section.canvas.height);
    section.lineWidth = 1;
    const disc = ([cx, cy, cz], radius, colour) => {
      const off = (cy - y) - side * Math.round((cy - y) / side);
      if (Math.abs(off) >= radius) return;
      section.fillStyle = colour;
      for (const i of [-x, 0, x]) {
        section.beginPath();
        section.arc((cx + i) * scale, (top - cz) * scale, Math.sqrt(radius ** 2 - off ** 2) * scale, 0, 2 * Math.PI);
        section.fill();
        section.stroke();
      }
    };
    section.strokeStyle = "#0003";
    const grains = view.earth.visible ? view.grains.count : 0, { radius: size, colour } = run.told.dermis;
    for (let n = 0; n < grains; n++) disc(run.dermal(view.frame * grains + n), size, colour);
    section.strokeStyle = "#0009";
    for (let n = run.start[view.frame]; n < run.start[view.frame + 1]; n++)
      disc(run.cell(n), radius, css(CELL_COLOURS[view.cellsBy].of(run, n)));
    section.strokeStyle = css(rgb(run.told.membrane).map((part) => part * 0.75));
    section.lineWidth = run.told.thickness * scale;
    section.lineCap = "round";
    section.beginPath();
    const place = view.sheet.attributes.position.array, corners = run.arrays.corners;
    for (let t = 0; t < corners.length; t += 3) {
      const ends = [];
      for (let k = 0; k < 3; k++) {
        const [a, b] = [3 * corners[t + k], 3 * corners[t + (k + 1) % 3]];
        const [from, to] = [place[a + 1] - y, place[b + 1] - y];
        if (from > 0 === to > 0) continue;
        const part = from / (from - to);
        ends.push([0, 2].map((axis) => place[a + axis] + part * (place[b + axis] - place[a + axis])));
      }
      if (ends.length === 2) {
        section.moveTo(ends[0][0] * scale, (top - ends[0][1]) * scale);
        section.lineTo(ends[1][0] * scale, (top - ends[1][1]) * scale);
      }
    }
    section.stroke();
  }
}
