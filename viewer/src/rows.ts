// Rows of numbers between rows of numbers: all that is computed here is how to draw what lies between samples.
import type { Axis, Body } from "./data";

/** A row of a table and how much of it. */
export type Weighed = [row: number, weight: number];

/** The rows around a moment of a movement of `rows` frames. */
export function around(rows: number, at: number): Weighed[] {
  const place = Math.min(Math.max(at, 0), rows - 1);
  const before = Math.min(Math.floor(place), rows - 1);
  const share = place - before;
  return share > 0 ? [[before, 1 - share], [before + 1, share]] : [[before, 1]];
}

/** The nodes of a grid around values of its axes, the last axis fastest. */
export function corners(axes: Axis[], values: number[]): Weighed[] {
  let nodes: Weighed[] = [[0, 1]];
  axes.forEach((axis, i) => {
    const share = (values[i] - axis.low) / (axis.high - axis.low);
    const along = around(axis.nodes, share * (axis.nodes - 1));
    nodes = nodes.flatMap(([n, w]) => along.map(([k, v]): Weighed => [n * axis.nodes + k, w * v]));
  });
  return nodes;
}

/** The weighted sum of rows of `width` numbers, written into `out`. */
export function blend(table: Float32Array, width: number, rows: Weighed[], out: Float32Array): void {
  out.fill(0);
  for (const [row, weight] of rows) {
    const first = row * width;
    for (let i = 0; i < width; i++) out[i] += weight * table[first + i];
  }
}

/** The points of a body in an order in which each comes after the one that it hangs on. */
export function outward({ parents }: Pick<Body, "parents">): number[] {
  const depth = (i: number): number => {
    let steps = 0;
    for (let at = parents[i] ?? null; at !== null && steps <= parents.length; at = parents[at] ?? null) steps += 1;
    return steps;
  };
  return parents.map((_, i) => i).sort((a, b) => depth(a) - depth(b) || a - b);
}

/** The weighted mean of postures, written into `out`: what hangs on a point turns about it and keeps its length. */
export function blendPosture(table: Float32Array, { parents }: Pick<Body, "parents">, order: number[], rows: Weighed[], out: Float32Array): void {
  const width = 3 * parents.length;
  for (const i of order) {
    // What hangs on a point that is missing goes its own way.
    const hangs = parents[i] !== null && !Number.isNaN(out[3 * (parents[i] ?? 0)]);
    const parent = hangs ? parents[i] : null;
    let x = 0, y = 0, z = 0, length = 0;
    for (const [row, weight] of rows) {
      const at = row * width + 3 * i;
      let dx = table[at], dy = table[at + 1], dz = table[at + 2];
      if (parent !== null) {
        const from = row * width + 3 * parent;
        dx -= table[from], dy -= table[from + 1], dz -= table[from + 2];
        length += weight * Math.hypot(dx, dy, dz);
      }
      x += weight * dx, y += weight * dy, z += weight * dz;
    }
    if (parent !== null) {
      const stretch = length / Math.max(Math.hypot(x, y, z), 1e-9);
      x = out[3 * parent] + stretch * x, y = out[3 * parent + 1] + stretch * y, z = out[3 * parent + 2] + stretch * z;
    }
    out[3 * i] = x, out[3 * i + 1] = y, out[3 * i + 2] = z;
  }
}
