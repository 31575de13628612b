// The pose: reads the packed bytes, and says where every bone is at a time.

/** Read the container that `packing.pack` writes: a JSON header, then the arrays it names. */
function unpack(view) {
  const buffer = view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength);
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const kinds = { f4: Float32Array, i2: Int16Array, i1: Int8Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array };
  const content = { ...header.facts };
  for (const { name, kind, shape, offset } of header.arrays) {
    const size = shape.reduce((a, b) => a * b, 1);
    content[name] = new kinds[kind](buffer, 4 + length + offset, size);
    content[name].shape = shape;
  }
  return content;
}

/** Two frames of a track, each `width` numbers from `start`, mixed. */
function mix(track, start, next, share, width) {
  return Array.from({ length: width }, (_, k) => (1 - share) * track[start + k] + share * track[next + k]);
}

/** The unit quaternion (w, x, y, z) between two, the short way round. */
function between(turns, start, next, share) {
  let alike = 0;
  for (let k = 0; k < 4; k++) alike += turns[start + k] * turns[next + k];
  const sign = alike < 0 ? -1 : 1;
  const blend = [0, 1, 2, 3].map((k) => (1 - share) * turns[start + k] + sign * share * turns[next + k]);
  return normalize(blend);
}
function toRows([w, x, y, z]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}
function compose(A, B) {
  return A.map((row) => [0, 1, 2].map((c) => row[0] * B[0][c] + row[1] * B[1][c] + row[2] * B[2][c]));
}

/** Where every joint of a body is at a time, and the bone rows that skin it. */
function poseAt(mesh, motion, body, time) {
  const [, frames, joints] = motion.turns.shape;
  const at = Math.min(Math.max(time * motion.fps, 0), frames - 1);
  const frame = Math.floor(at);
  const first = body * frames + frame;
  const second = body * frames + Math.min(frame + 1, frames - 1);
  const move = mix(motion.trans, 3 * first, 3 * second, at - frame, 3);
  const count = motion.curves.shape[2];
  const curves = mix(motion.curves, count * first, count * second, at - frame, count);
  const rest = (j) => mesh.joints.subarray(3 * j, 3 * j + 3);
  const turns = [], places = [], skin = new Float32Array(12 * joints);
  for (let j = 0; j < joints; j++) {
    const local = toRows(between(motion.turns, 4 * (first * joints + j), 4 * (second * joints + j), at - frame));
    const p = mesh.parents[j];
    if (p < 0) {
      turns.push(local);
      places.push(move.map((m, k) => m + rest(j)[k]));
    } else {
      const bone = rest(j).map((x, k) => x - rest(p)[k]);
      turns.push(compose(turns[p], local));
      places.push(places[p].map((x, k) => x + dot(turns[p][k], bone)));
    }
    turns[j].forEach((row, k) => skin.set([...row, places[j][k] - dot(row, rest(j))], 12 * j + 4 * k));
  }
  return { skin, curves, places };
}
