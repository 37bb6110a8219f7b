// node test/screenshot.mjs PAGE.html PICTURE.png: the picture of a page for the README, small.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { executablePath, launch, open, redrawn, until } from "./browser.mjs";

const [file, picture] = process.argv.slice(2);
if (!executablePath) throw new Error("no Chromium here (Debian: apt install chromium; or KINEME_CHROMIUM names one)");
const browser = await launch();
const { page } = await open(browser, pathToFileURL(resolve(file)).href, { viewport: { width: 800, height: 800 }, reducedMotion: "reduce" });
const stage = "#stage canvas";
await until(page, () => document.querySelector("#stage canvas")?.dataset.drawn !== undefined);
await redrawn(page, stage, () => page.evaluate(() => {
  const clock = document.querySelector("#stage .scrub");
  clock.value = String(0.268 * Number(clock.max));
  clock.dispatchEvent(new Event("input"));
  document.querySelector("#stage").scrollIntoView();
  // Even colours pack small.
  document.querySelector("#stage .viewport").style.background = "#f1f3f6";
}));
await page.waitForTimeout(1000);
await page.locator("#stage").screenshot({ path: picture, timeout: 120000 });
await browser.close();
