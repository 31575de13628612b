// Mixing warps in the page: the formulas of s2glib/warping/flow.py, once more.

const LIMIT = 8; // gains go from -8, which means off, to 8
const OFF = -100; // what being off adds to a logit

/** The value of a square map between its pixels, bilinear; nothing lies outside. */
function lookUp(map, size, x, y) {
  const left = Math.floor(x), top = Math.floor(y);
  let sum = 0;
  for (let row = Math.max(top, 0); row <= Math.min(top + 1, size - 1); row++)
    for (let column = Math.max(left, 0); column <= Math.min(left + 1, size - 1); column++)
      sum += (1 - Math.abs(x - column)) * (1 - Math.abs(y - row)) * map[row * size + column];
  return sum;
}

/** A map, number by number: a plain loop, for it has to be quick. */
function fillMap(count, valueAt) {
  const map = new Float64Array(count);
  for (let p = 0; p < count; p++) map[p] = valueAt(p);
  return map;
}

/** The same map on more pixels; its corners stay corners. */
function enlarge(map, size, newSize) {
  const step = (size - 1) / (newSize - 1);
  return fillMap(newSize ** 2, (p) => lookUp(map, size, step * (p % newSize), step * Math.floor(p / newSize)));
}

/** The planes of a stack of square maps. */
const planes = (stack, size) => Array.from({ length: stack.length / size ** 2 }, (_, k) => stack.subarray(k * size ** 2, (k + 1) * size ** 2));

class Mixing {
  constructor(bytes) {
    const { warps, shares, ...pictures } = unpack(bytes);
    const [count, coarse] = shares.shape;
    Object.assign(this, { count, coarse, size: pictures.source.shape[1], shares: planes(shares, coarse) });
    for (const [name, steps] of Object.entries(pictures)) this[name] = planes(Float32Array.from(steps, (step) => step / 65535), this.size);
    const axes = planes(warps, coarse);
    this.warps = this.shares.map((_, k) => axes.slice(2 * k, 2 * k + 2));
  }

  /** Weight maps, after what is added to the logits: a softmax of log s + a is s e^a over its sum. */
  weigh(added) {
    const loud = this.shares.map((share, k) => fillMap(share.length, (p) => share[p] * Math.exp(added[k])));
    const sum = fillMap(loud[0].length, (p) => loud.reduce((total, map) => total + map[p], 0));
    return loud.map((map) => fillMap(map.length, (p) => map[p] / sum[p]));
  }

  /** The flow: the weighted mean of the warps, x and y. */
  combine(weights) {
    const mean = (axis) => (p) => weights.reduce((sum, map, k) => sum + map[p] * this.warps[k][axis][p], 0);
    return [0, 1].map((axis) => fillMap(weights[0].length, mean(axis)));
  }

  /** The source picture as a flow shows it. */
  bend(flow) {
    const pixel = (place) => ((place + 1) / 2) * (this.size - 1);
    const [x, y] = flow.map((axis) => enlarge(axis, this.coarse, this.size));
    return this.source.map((color) => fillMap(color.length, (p) => lookUp(color, this.size, pixel(x[p]), pixel(y[p]))));
  }

  /** The bent source, hidden where the occlusion mask says so, with the network's paint instead. */
  fill(bent) {
    const { visible: [visible], paint } = this;
    return bent.map((color, c) => fillMap(color.length, (p) => color[p] * visible[p] + paint[c][p]));
  }

  /** Mean absolute difference of a picture to the driving one. */
  error(picture) {
    let sum = 0;
    picture.forEach((color, c) => {
      for (let p = 0; p < color.length; p++) sum += Math.abs(color[p] - this.driving[c][p]);
    });
    return sum / (3 * this.size ** 2);
  }
}
