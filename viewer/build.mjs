// Bundles the viewer into dist/viewer.js and dist/viewer.css, which kineme-report carries.
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

await build({
  entryPoints: { viewer: "src/main.ts" },
  outdir: "dist",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "inline",
  charset: "ascii",
  logLevel: "info",
});

// The script stands inside a page: nothing in it may end its element.
const file = "dist/viewer.js";
const script = await readFile(file, "utf8");
const safe = script.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
if (safe !== script) await writeFile(file, safe);
