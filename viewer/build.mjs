// Bundles the viewer into dist/viewer.js and dist/viewer.css, which kineme-report carries.
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname } from "node:path";
import { build } from "esbuild";

const { outputFiles } = await build({
  entryPoints: { viewer: "src/main.ts" },
  outdir: "dist",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "inline",
  charset: "ascii",
  logLevel: "info",
  write: false,
});

for (const { path, text } of outputFiles) {
  // The script stands inside a page: nothing in it may end its element.
  const script = path.endsWith(".js");
  const safe = script ? text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--") : text;
  // A file that is written anew is a minute of compiling, be it the same or not.
  const before = await readFile(path, "utf8").catch(() => undefined);
  if (safe === before) continue;
  await mkdir(dirname(path), { recursive: true });
  await writeFile(path, safe);
}
