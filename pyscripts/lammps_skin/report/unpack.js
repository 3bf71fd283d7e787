"use strict";
// arrays as packing.py packs them

const TYPES = { u1: Uint8Array, u2: Uint16Array, i2: Int16Array, i4: Int32Array,
  f4: Float32Array, f8: Float64Array };

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let n = 0; n < text.length; n++) bytes[n] = text.charCodeAt(n);
  return bytes;
}

async function unpack(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let at = bytes.indexOf(10) + 1;
  const arrays = {};
  for (const { name, type, shape, steady } of JSON.parse(new TextDecoder().decode(bytes.subarray(0, at)))) {
    const values = new TYPES[type](shape.reduce((a, b) => a * b, 1));
    const size = values.BYTES_PER_ELEMENT, whole = new Uint8Array(values.buffer);
    for (let rank = 0; rank < size; rank++)
      for (let n = 0; n < values.length; n++) whole[n * size + rank] = bytes[at++];
    const row = values.length / shape[0];
    if (steady) for (let n = row; n < values.length; n++) values[n] += values[n - row];
    arrays[name] = values;
  }
  return arrays;
}

// a run: what JSON tells of it, its arrays, and where the cells of each frame begin
class Run {
  constructor(told, arrays) {
    Object.assign(this, { told, arrays });
    this.points = arrays.membrane.length / 3 / told.frames.length;
    this.start = [0];
    for (const number of arrays.number) this.start.push(this.start.at(-1) + number);
    this.kinds = new Map(told.kinds.map((kind) => [kind.number, kind]));
    this.clones = new Map(Object.entries(told.clones).map(([founder, colour]) => [Number(founder), colour]));
    this.most = { left: 1, below: 3 };
    for (const name of ["left", "below"])
      this.most[name] = arrays["cell_" + name].reduce((a, b) => Math.max(a, b), this.most[name]);
    const { low, high } = told.ranges;
    this.low = low;
    this.unit = high.map((end, axis) => (end - low[axis]) / 65535);
  }

  get last() { return this.told.frames.length - 1; }

  // number of the frame nearest to a time
  frameAt(time) {
    let best = 0;
    this.told.frames.forEach((t, n) => {
      if (Math.abs(t - time) < Math.abs(this.told.frames[best] - time)) best = n;
    });
    return best;
  }

  length(array, n, axis) { return this.low[axis] + this.unit[axis] * array[3 * n + axis]; }
  dermal(n) { return [0, 1, 2].map((axis) => this.length(this.arrays.dermis, n, axis)); }
  cell(n) { return [0, 1, 2].map((axis) => this.length(this.arrays.cells, n, axis)); }
  point(frame, n, axis) { return this.length(this.arrays.membrane, frame * this.points + n, axis); }
}
