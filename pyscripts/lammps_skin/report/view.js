"use strict";
// the membrane and the cells of a run in three dimensions

const LOOKS = { aside: [-62, 35], above: [-90, 90], below: [-62, -35] }; // azimuth, elevation
const FIELD = 26; // degrees seen from bottom to top
const CHOSEN = 0xff1493;
const WHOLE = 1.5; // width over height of a picture from which on its height limits what is seen

class View {
  constructor(host, run, camera, choices) {
    Object.assign(this, { camera, frame: 0, hidden: new Set(), chosen: 0, ...choices });
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xf2f4f7);
    this.lens = new THREE.PerspectiveCamera(FIELD, 1, 1, 2000);
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    lamp.position.set(-0.6, 0.8, 0.7);
    this.lens.add(lamp);
    this.scene.add(this.lens, new THREE.HemisphereLight(0xffffff, 0xc8c4c0, 0.62));
    this.tiles = new THREE.Group();
    this.plane = new THREE.Plane();
    this.scene.add(this.tiles);
    this.take(run);
    new ResizeObserver(() => this.resize(host)).observe(host);
    this.resize(host);
    this.listen(this.renderer.domElement);
  }

  // another run, or the same one grown
  take(run) {
    this.run = run;
    for (const old of [this.sheet, this.ball, this.balls, this.grain, this.grains]) old?.dispose();
    const { points, arrays, told } = run, copies = arrays.copies.length / 3;
    this.sheet = new THREE.BufferGeometry();
    for (const name of ["position", "normal", "color"])
      this.sheet.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * (points + copies)), 3));
    this.sheet.setIndex(new THREE.BufferAttribute(new Uint32Array(arrays.corners), 1));
    const most = arrays.number.reduce((a, b) => Math.max(a, b), 1);
    this.ball = most > 3000 ? new THREE.SphereGeometry(1, 12, 9) : new THREE.SphereGeometry(1, 20, 14);
    this.paint = new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide });
    this.paint.visible = this.sheetShown ?? true;
    this.skin = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
    this.balls = new THREE.InstancedMesh(this.ball, this.skin, most);
    this.balls.setColorAt(0, new THREE.Color());
    this.numbers = new Int32Array(most); // of the cells that are drawn
    this.takeDermis();
    const [x, y] = told.box;
    this.sides = [[1, 0, 0], [-1, 0, x], [0, 1, 0], [0, -1, y]].map(
      ([a, b, c]) => new THREE.Plane(new THREE.Vector3(a, b, 0), c));
    this.ring = new THREE.Mesh(this.ball, new THREE.MeshBasicMaterial({ color: CHOSEN, transparent: true, opacity: 0.55 }));
    this.ring.scale.setScalar(1.25 * told.radius);
    this.tile(this.copied ?? false);
  }

  // particles of the dermis, if the page has them
  takeDermis() {
    const { dermis, number } = this.run.arrays, { radius, colour } = this.run.told.dermis;
    const grains = dermis ? dermis.length / 3 / number.length : 0;
    this.grain = new THREE.SphereGeometry(radius, 10, 7);
    this.earth = new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide });
    this.earth.visible = grains > 0 && (this.dermisShown ?? true);
    this.grains = new THREE.InstancedMesh(this.grain, this.earth, grains);
  }

  // the box alone, or with its eight neighbors
  tile(copies) {
    this.copied = copies;
    this.tiles.clear();
    const [x, y] = this.run.told.box, around = copies ? [-1, 0, 1] : [0];
    for (const i of around) for (const j of around) {
      const cells = i || j ? new THREE.InstancedMesh(this.ball, this.skin, 0) : this.balls;
      cells.instanceMatrix = this.balls.instanceMatrix;
      cells.instanceColor = this.balls.instanceColor;
      cells.frustumCulled = false;
      const sheet = new THREE.Mesh(this.sheet, this.paint);
      sheet.frustumCulled = false;
      const tile = new THREE.Group();
      tile.position.set(i * x, j * y, 0);
      const dermis = new THREE.InstancedMesh(this.grain, this.earth, 0);
      dermis.instanceMatrix = this.grains.instanceMatrix;
      dermis.count = this.grains.count;
      dermis.frustumCulled = false;
      tile.add(sheet, cells, dermis);
      this.tiles.add(tile);
    }
    this.tiles.add(this.ring);
    this.cut();
    this.show(this.frame);
  }

  // cut away what is in front of a plane across an axis, at a share of the way
  cut(axis = this.axis, share = this.share) {
    Object.assign(this, { axis, share });
    const planes = axis ? [this.plane] : [];
    this.skin.clippingPlanes = this.earth.clippingPlanes = planes;
    this.paint.clippingPlanes = this.copied ? planes : [...planes, ...this.sides];
    this.draw();
  }

  // keep the side of the plane on which the viewer is not
  turnPlane() {
    if (!this.axis) return;
    const n = "xyz".indexOf(this.axis), { low, high } = this.run.told.ranges;
    const from = n < 2 && this.copied ? -this.run.told.box[n] : low[n];
    const to = n < 2 && this.copied ? 2 * this.run.told.box[n] : high[n] + this.run.told.radius;
    const at = from + this.share * (to - from);
    const side = this.lens.position.getComponent(n) < (from + to) / 2 ? 1 : -1;
    this.plane.normal.set(0, 0, 0).setComponent(n, side);
    this.plane.constant = -side * at;
  }

  showSheet(shown) {
    this.sheetShown = this.paint.visible = shown;
    this.draw();
  }

  showDermis(shown) {
    this.dermisShown = shown;
    this.earth.visible = shown && this.grains.count > 0;
    this.draw();
  }

  show(frame) {
    this.frame = Math.min(frame, this.run.last);
    this.showMembrane();
    this.showCells();
    for (let n = 0; n < this.grains.count; n++) {
      const at = this.frame * this.grains.count + n, matrix = this.grains.instanceMatrix.array;
      matrix[16 * n] = matrix[16 * n + 5] = matrix[16 * n + 10] = matrix[16 * n + 15] = 1;
      matrix.set(this.run.dermal(at), 16 * n + 12);
    }
    this.grains.instanceMatrix.needsUpdate = true;
    this.draw();
  }

  showMembrane() {
    const { run, frame, sheet } = this, { points, arrays } = run, [x, y] = run.told.box;
    const place = sheet.attributes.position.array, normal = sheet.attributes.normal.array;
    const colour = sheet.attributes.color.array, of = MEMBRANE_COLOURS[this.membraneBy].of;
    for (let n = 0; n < points; n++) {
      for (let axis = 0; axis < 3; axis++) place[3 * n + axis] = run.point(frame, n, axis);
      colour.set(of(run, frame, n), 3 * n);
    }
    const copies = arrays.copies, base = (v) => (v < points ? v : copies[3 * (v - points)]);
    for (let g = 0; g < copies.length / 3; g++) {
      const from = 3 * copies[3 * g], to = 3 * (points + g);
      place[to] = place[from] + copies[3 * g + 1] * x;
      place[to + 1] = place[from + 1] + copies[3 * g + 2] * y;
      place[to + 2] = place[from + 2];
      colour.copyWithin(to, from, from + 3);
    }
    normal.fill(0);
    const corners = arrays.corners;
    for (let t = 0; t < corners.length; t += 3) {
      const [a, b, c] = [3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2]];
      const u = [0, 1, 2].map((k) => place[b + k] - place[a + k]);
      const v = [0, 1, 2].map((k) => place[c + k] - place[a + k]);
      for (let corner = 0; corner < 3; corner++) {
        const to = 3 * base(corners[t + corner]);
        normal[to] += u[1] * v[2] - u[2] * v[1];
        normal[to + 1] += u[2] * v[0] - u[0] * v[2];
        normal[to + 2] += u[0] * v[1] - u[1] * v[0];
      }
    }
    for (let g = 0; g < copies.length / 3; g++)
      normal.copyWithin(3 * (points + g), 3 * copies[3 * g], 3 * copies[3 * g] + 3);
    for (const name of ["position", "normal", "color"]) sheet.attributes[name].needsUpdate = true;
  }

  showCells() {
    const { run, frame, balls, hidden } = this, radius = run.told.radius;
    const matrix = balls.instanceMatrix.array.fill(0), colours = balls.instanceColor.array;
    const of = CELL_COLOURS[this.cellsBy].of;
    let drawn = 0;
    this.ring.visible = false;
    for (let n = run.start[frame]; n < run.start[frame + 1]; n++) {
      if (hidden.has(run.kinds.get(run.arrays.cell_kind[n]).label)) continue;
      const place = run.cell(n), at = 16 * drawn;
      matrix[at] = matrix[at + 5] = matrix[at + 10] = radius;
      matrix[at + 15] = 1;
      matrix.set(place, at + 12);
      colours.set(of(run, n), 3 * drawn);
      this.numbers[drawn++] = n;
      if (run.arrays.cell_id[n] === this.chosen) {
        this.ring.position.set(...place);
        this.ring.visible = true;
      }
    }
    for (const tile of this.tiles.children) if (tile !== this.ring) tile.children[1].count = drawn;
    balls.instanceMatrix.needsUpdate = balls.instanceColor.needsUpdate = true;
    this.drawn = drawn;
  }

  draw() {
    if (this.due) return;
    this.due = requestAnimationFrame(() => {
      this.due = 0;
      const { azimuth, elevation, distance, shift } = this.camera, [x, y] = this.run.told.box;
      const { low: [, , bottom], high: [, , top], height } = this.run.told.ranges;
      const [low, high] = this.earth.visible ? [bottom, top] : height, turn = Math.PI / 180;
      const [a, e] = [azimuth * turn, Math.min(Math.max(elevation, -89.9), 89.9) * turn];
      const target = new THREE.Vector3(x / 2, y / 2, (low + high) / 2).add(shift);
      const away = distance * Math.max(x, y) * Math.max(WHOLE / this.lens.aspect, 1);
      this.lens.position.set(Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e))
        .multiplyScalar(away).add(target);
      this.lens.up.set(0, 0, 1);
      this.lens.lookAt(target);
      this.turnPlane();
      this.renderer.render(this.scene, this.lens);
    });
  }

  resize(host) {
    const { clientWidth: width, clientHeight: height } = host;
    this.renderer.setSize(width, height, false);
    this.lens.aspect = width / height;
    this.lens.updateProjectionMatrix();
    this.draw();
  }

  // number of the cell at a place of the picture, -1 if there is none in front
  cellAt(x, y) {
    const ray = new THREE.Raycaster(), box = this.renderer.domElement.getBoundingClientRect();
    ray.setFromCamera({ x: 2 * (x - box.left) / box.width - 1, y: 1 - 2 * (y - box.top) / box.height }, this.lens);
    const seen = this.tiles.children.filter((tile) => tile !== this.ring).flatMap((tile) => tile.children);
    const hit = ray.intersectObjects(seen.filter((thing) => thing.material.visible), false).find(
      ({ object, point }) => (object.material.clippingPlanes).every((plane) => plane.distanceToPoint(point) >= 0));
    return hit && hit.object.material === this.skin ? this.numbers[hit.instanceId] : -1;
  }

  listen(canvas) {
    let from = null, moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      moved = 0;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      const [dx, dy] = [event.clientX - from[0], event.clientY - from[1]];
      from = [event.clientX, event.clientY];
      moved += Math.abs(dx) + Math.abs(dy);
      if (event.shiftKey || event.buttons === 2) this.camera.move(dx, dy, this);
      else this.camera.turn(dx, dy);
    });
    canvas.addEventListener("pointerup", (event) => {
      from = null;
      if (moved < 5) this.onChoose(this.cellAt(event.clientX, event.clientY));
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.camera.come(Math.exp(event.deltaY / 600));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }
}

// where the viewers of all runs stand
class Camera {
  constructor(changed) {
    this.changed = changed;
    this.shift = new THREE.Vector3();
    this.look("aside");
  }

  look(name) {
    [this.azimuth, this.elevation] = LOOKS[name];
    this.distance = 2.35;
    this.shift.set(0, 0, 0);
    this.changed();
  }

  turn(dx, dy) {
    this.azimuth -= 0.4 * dx;
    this.elevation = Math.min(Math.max(this.elevation + 0.4 * dy, -90), 90);
    this.changed();
  }

  come(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.15), 12);
    this.changed();
  }

  move(dx, dy, view) {
    const [x, y] = view.run.told.box, height = view.renderer.domElement.clientHeight;
    const scale = 2 * Math.tan(FIELD * Math.PI / 360) * this.distance * Math.max(x, y) / height;
    const [right, up] = [0, 1].map((n) => new THREE.Vector3().setFromMatrixColumn(view.lens.matrixWorld, n));
    this.shift.addScaledVector(right, -dx * scale).addScaledVector(up, dy * scale);
    this.changed();
  }
}
