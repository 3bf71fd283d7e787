"use strict";
// the page: reads its runs, and lets all that is shown follow the time and the choices

const $ = (id) => document.getElementById(id);
const AGAIN = 2000; // milliseconds between two looks at a run that goes on

class Page {
  // runs, and the study to which they belong, if any; it may have kept none
  constructor(runs, study) {
    Object.assign(this, { runs, study });
    document.body.classList.toggle("without-runs", !runs.length);
    document.body.classList.toggle("without-study", !study);
    if (study) this.answer = new Answer($("answer"), $("window"), study);
    this.time = Math.max(...this.times());
    this.chosen = null;
    this.camera = new Camera(() => this.views?.forEach((view) => view.draw()));
    this.fillChoices();
    this.views = runs.map((run) => this.addView(run));
    this.maps = runs.map((run) => new Maps($("maps"), run, runs.length > 1 || study ? run.told.name : ""));
    $("dermis-choice").hidden = !runs.some((run) => run.arrays.dermis);
    this.take(runs);
    this.listen();
  }

  times() {
    const { runs, study } = this;
    return runs.length ? runs.flatMap((run) => run.told.frames) : study.curves.flatMap((curve) => curve.table.time);
  }

  // runs that are new, or have grown
  take(runs) {
    const atEnd = this.time >= this.steps?.at(-1);
    this.runs = runs;
    this.steps = [...new Set(this.times())].sort((a, b) => a - b);
    $("slider").max = this.steps.length - 1;
    this.views.forEach((view, n) => { if (view.run !== runs[n]) view.take(runs[n]); });
    this.maps.forEach((maps, n) => maps.take(runs[n]));
    const curves = this.study ? this.study.curves : runs.map((run) => run.told);
    this.charts = new Charts($("charts"), curves, (time) => this.goTo(time));
    legendOfCurves($("curves"), curves, (hidden) => {
      this.charts = new Charts($("charts"), curves, (time) => this.goTo(time), hidden);
      this.charts.show(this.time);
    });
    $("lead").textContent = leadOf(this.runs, this.study);
    $("warnings").innerHTML = warningsOf(this.runs, this.study);
    $("made").innerHTML = (this.study ? madeOf(this.study) : "") + runs.map(made).join("");
    this.goTo(atEnd ? this.steps.at(-1) : this.time);
  }

  addView(run) {
    const host = document.createElement("div");
    host.className = "view";
    $("views").append(host);
    const view = new View(host, run, this.camera, this.choices());
    view.caption = document.createElement("p");
    host.append(view.caption);
    view.onChoose = (n) => this.choose(view, n);
    return view;
  }

  choices() { return { cellsBy: $("cells-by").value, membraneBy: $("membrane-by").value }; }

  fillChoices() {
    const options = (all) => Object.entries(all).map(([name, { title }]) => `<option value="${name}">${title}</option>`).join("");
    $("cells-by").innerHTML = options(CELL_COLOURS);
    $("membrane-by").innerHTML = options(MEMBRANE_COLOURS);
    const kinds = new Map(this.runs.flatMap((run) => run.told.kinds.map((kind) => [kind.label, kind])));
    $("kinds").innerHTML = [...kinds.values()].map(({ label, name, colour }) =>
      `<label class="check"><input type="checkbox" value="${clean(label)}" checked>
       <span class="swatch" style="background:${colour}"></span>${clean(name)}</label>`).join("");
  }

  goTo(time) {
    const nearest = this.steps.reduce((best, step, n) => Math.abs(step - time) < Math.abs(this.steps[best] - time) ? n : best, 0);
    this.time = this.steps[nearest];
    $("slider").value = nearest;
    this.show();
  }

  show() {
    const hidden = new Set([...$("kinds").querySelectorAll("input:not(:checked)")].map((box) => box.value));
    $("time").textContent = `t = ${short(this.time)} of ${short(this.steps.at(-1))}`;
    $("cells-legend").innerHTML = legendOf(CELL_COLOURS[$("cells-by").value], this.runs);
    $("membrane-legend").innerHTML = legendOf(MEMBRANE_COLOURS[$("membrane-by").value], this.runs);
    this.views.forEach((view, n) => {
      Object.assign(view, this.choices(), { hidden });
      view.show(view.run.frameAt(this.time));
      view.caption.textContent = `${this.runs.length > 1 || this.study ? `${view.run.told.name}, ` : ""}t = ${short(view.run.told.frames[view.frame])}: `
        + `${counted(view.drawn, "cell")} drawn`;
      this.maps[n].show(view, Number($("section-y").value));
    });
    const sections = this.runs.map((run) => `y = ${short(run.told.box[1] * $("section-y").value)}`);
    $("section-at").textContent = [...new Set(sections)].join(" | ");
    this.charts.show(this.time);
    $("events").innerHTML = this.runs.map((run) => events(run, this.time)).join("");
    this.tellHistory();
  }

  choose(view, n) {
    for (const one of this.views) one.chosen = one.clone = 0;
    this.chosen = n < 0 ? null : { view, id: view.run.arrays.cell_id[n] };
    if (this.chosen) {
      view.chosen = this.chosen.id;
      view.clone = view.run.arrays.cell_clone[n];
    }
    this.show();
  }

  tellHistory() {
    const { chosen } = this;
    $("history").innerHTML = chosen
      ? history(chosen.view.run, chosen.view.frame, chosen.id, this.runs.length === 1)
      : '<p class="hint">Click a cell in the picture above.</p>';
  }

  play(playing) {
    clearInterval(this.playing);
    this.playing = 0;
    $("play").textContent = playing ? "Stop" : "Play";
    if (!playing) return;
    if (Number($("slider").value) === this.steps.length - 1) this.goTo(this.steps[0]);
    this.playing = setInterval(() => {
      const next = Number($("slider").value) + 1;
      if (next < this.steps.length) this.goTo(this.steps[next]); else this.play(false);
    }, 1000 / $("speed").value);
  }

  listen() {
    $("slider").addEventListener("input", () => this.goTo(this.steps[$("slider").value]));
    $("play").addEventListener("click", () => this.play(!this.playing));
    $("speed").addEventListener("change", () => this.playing && this.play(true));
    for (const id of ["cells-by", "membrane-by", "kinds", "section-y"])
      $(id).addEventListener("input", () => this.show());
    $("membrane-shown").addEventListener("input", () => this.all((view) => view.showSheet($("membrane-shown").checked)));
    $("dermis-shown").addEventListener("input", () => {
      this.all((view) => view.showDermis($("dermis-shown").checked));
      this.show();
    });
    $("copies").addEventListener("input", () => this.all((view) => view.tile($("copies").checked)));
    for (const id of ["clip-axis", "clip-at"]) $(id).addEventListener("input", () => {
      $("clip-at").hidden = !$("clip-axis").value;
      this.all((view) => view.cut($("clip-axis").value, Number($("clip-at").value)));
    });
    for (const button of document.querySelectorAll("[data-look]"))
      button.addEventListener("click", () => this.camera.look(button.dataset.look));
    document.addEventListener("keydown", (event) => {
      if (event.code !== "Space" || event.target.matches("input, select, button")) return;
      event.preventDefault();
      this.play(!this.playing);
    });
  }

  all(change) { this.views.forEach(change); }
}

async function embedded() {
  const runs = [];
  for (let n = 0; $(`told-${n}`); n++) {
    const packed = $(`packed-${n}`);
    runs.push(new Run(JSON.parse($(`told-${n}`).textContent), await unpack(bytesOf(packed.textContent))));
    packed.remove(); // its text is as large as the arrays
  }
  return runs;
}

// a run that goes on: what is new comes from the address of the page
async function follow(page, version) {
  try {
    const answer = await fetch(`/news?after=${version}`);
    if (answer.status === 200) {
      const bytes = new Uint8Array(await answer.arrayBuffer()), end = bytes.indexOf(10);
      const news = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
      page.take([new Run(news.told, await unpack(bytes.subarray(end + 1)))]);
      version = news.version;
    }
  } catch (error) {
    $("lead").textContent = "The run is no longer served: skin watch has ended.";
    return;
  }
  setTimeout(() => follow(page, version), AGAIN);
}

embedded().then((runs) => {
  window.page = new Page(runs, JSON.parse($("study").textContent));
  document.body.dataset.ready = "yes";
  if (SETTINGS.live) follow(window.page, SETTINGS.live);
});
