// Thin-plate splines in the page: the formulas of s2glib/warping/tps.py, once more.

const squaredDistance = ([x, y], [a, b]) => (x - a) ** 2 + (y - b) ** 2;

/** U(r) = r^2 log r^2, as a function of r^2  [MDD Eq. A2]. */
const radialBasis = (squared) => (squared > 0 ? squared * Math.log(squared) : 0);

/** Gauss and Jordan: turn rows of [L | Y] into the solution's rows; null if L has no inverse. */
function solve(rows) {
  const largest = Math.max(...rows.flatMap((row) => row.slice(0, rows.length).map(Math.abs)));
  for (let k = 0; k < rows.length; k++) {
    let best = k;
    for (let i = k + 1; i < rows.length; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    [rows[k], rows[best]] = [rows[best], rows[k]];
    if (!(Math.abs(rows[k][k]) > 1e-13 * largest)) return null;
    for (let i = 0; i < rows.length; i++) {
      const share = i === k ? 0 : rows[i][k] / rows[k][k];
      if (share) for (let j = k; j < rows[i].length; j++) rows[i][j] -= share * rows[k][j];
    }
  }
  return rows.map((row, k) => row.slice(rows.length).map((value) => value / row[k]));
}

/** The spline that takes each driving point to its source point  [MDD Eq. A5]; null if none does. */
function fitTps(driving, source, ridge) {
  const n = driving.length;
  const P = driving.map(([x, y]) => [1, x, y]);
  const upper = driving.map((p, i) => [...driving.map((q) => radialBasis(squaredDistance(p, q))), ...P[i], ...source[i]]);
  const lower = [0, 1, 2].map((k) => [...P.map((row) => row[k]), 0, 0, 0, 0, 0]);
  const rows = [...upper, ...lower];
  rows.forEach((row, k) => (row[k] += ridge));
  const solution = solve(rows);
  return solution && { centers: driving, weights: solution.slice(0, n), affine: solution.slice(n) };
}

/** Where the spline takes a point  [MDD Eq. A2]. */
function applyTps({ centers, weights, affine }, point) {
  const moved = [0, 1].map((k) => affine[0][k] + affine[1][k] * point[0] + affine[2][k] * point[1]);
  centers.forEach((center, i) => {
    const U = radialBasis(squaredDistance(point, center));
    moved[0] += U * weights[i][0];
    moved[1] += U * weights[i][1];
  });
  return moved;
}

/** The integral that the spline makes smallest  [MDD Eq. A1]. */
function bendingEnergy({ centers, weights }) {
  let sum = 0;
  centers.forEach((p, i) => centers.forEach((q, j) => {
    sum += (weights[i][0] * weights[j][0] + weights[i][1] * weights[j][1]) * radialBasis(squaredDistance(p, q));
  }));
  return 16 * Math.PI * sum;
}
