// node test/data.mjs: what the page's numbers mean, and the command that the reader's names become.
import assert from "node:assert/strict";
import { build } from "esbuild";

async function load(file) {
  const { outputFiles } = await build({ entryPoints: [file], bundle: true, format: "esm", write: false });
  return import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
}

const { places } = await load("src/data.ts");
const wholes = [[30000, 0, -1], [-30000, 32767, 1], [-32768, -32767, 0], [5, -32768, -32768], [32767, 7, -32768]];
const before = [0, 0, 0];
const packed = new Int16Array(wholes.flatMap((row) => row.map((whole, i) => {
  const by = whole - before[i];
  before[i] = whole;
  return by;
})));
const table = places({ rows: wholes.length, points: 1, step: 0.5, data: Buffer.from(packed.buffer).toString("base64") });
assert.deepEqual([...table], wholes.flat().map((whole) => (whole === -32768 ? NaN : 0.5 * whole)));
console.log("ok: differences wrap round, and what is missing stays missing");

const { command } = await load("src/edits.ts");
const entry = (name, wanted = name, removed = false) => ({ name, wanted, removed });
for (const [file, entries, wanted] of [
  ["a.kineme", [entry("x"), entry("y")], ""],
  ["a.kineme", [entry("x", "jab"), entry("y")], "kineme edit a.kineme -o a-edited.kineme --rename x=jab"],
  ["a.kineme", [entry("x", "y"), entry("y", "x")], "kineme edit a.kineme -o a-edited.kineme --rename x=y --rename y=x"],
  ["a.kineme", [entry("x", "y"), entry("y"), entry("z", "z", true)], "kineme edit a.kineme -o a-edited.kineme --merge x,y=y --remove z"],
  ["my set/a.kineme", [entry("x", "it's")], "kineme edit 'my set/a.kineme' -o 'my set/a-edited.kineme' --rename 'x=it'\\''s'"],
  ["a", [entry("x", "q", true)], "kineme edit a -o a-edited --remove x"],
]) assert.equal(command(file, entries), wanted);
console.log("ok: new names, the same name for several, and what is crossed out become one command");
