// Rows of numbers between rows of numbers: all that is computed here is how to draw what lies between two samples.
import type { Axis } from "./data";

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
