// node test/rows.mjs: what is drawn between two samples.
import assert from "node:assert/strict";
import { build } from "esbuild";

const { outputFiles } = await build({ entryPoints: ["src/rows.ts"], bundle: true, format: "esm", write: false });
const { blendPosture, outward } = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);

/** An arm of two bones of 0.3 m that hangs on a shoulder; its hand is listed before its elbow. */
const arm = { parents: [null, 2, 0] };
const posture = (angle) => {
  const [y, z] = [0.3 * Math.cos(angle), 0.3 * Math.sin(angle)];
  return [1, 0, 1.4, 1, 2 * y, 1.4 + 2 * z, 1, y, 1.4 + z];
};
const length = (p, i, j) => Math.hypot(...[0, 1, 2].map((c) => p[3 * i + c] - p[3 * j + c]));

const order = outward(arm);
assert.deepEqual(order, [0, 2, 1]);
const table = new Float32Array([...posture(-0.6), ...posture(0.6)]);
const out = new Float32Array(9);
for (const share of [0, 0.25, 0.5, 1]) {
  blendPosture(table, arm, order, [[0, 1 - share], [1, share]], out);
  assert.ok(Math.abs(length(out, 0, 2) - 0.3) < 1e-6 && Math.abs(length(out, 2, 1) - 0.3) < 1e-6, `${share}: ${out}`);
}
blendPosture(table, arm, order, [[0, 0.5], [1, 0.5]], out);
posture(0).forEach((c, i) => assert.ok(Math.abs(out[i] - c) < 1e-6, `${i}`));
console.log("ok: a limb that turns keeps its length between samples, and halfway is half turned");

const lost = new Float32Array([...posture(0), ...posture(0.2)]);
lost.fill(NaN, 6, 9);
blendPosture(lost, arm, order, [[0, 1]], out);
assert.ok(Number.isNaN(out[6]) && Math.abs(out[4] - 0.6) < 1e-6, `${out}`);
console.log("ok: what hangs on a missing point is where it was seen");
