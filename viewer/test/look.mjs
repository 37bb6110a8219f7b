// node test/look.mjs PAGE.html FOLDER: pictures of a page, to be looked at.
import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launch, open, until } from "./browser.mjs";

const [file, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
// Every clock at a share of its time.
async function put(page, share) {
  await until(page, () => document.querySelector("canvas[data-drawn]") !== null);
  await page.waitForTimeout(1500);
  await page.evaluate((share) => {
    for (const clock of document.querySelectorAll(".scrub")) {
      clock.value = String(share * Number(clock.max));
      clock.dispatchEvent(new Event("input"));
    }
  }, share);
  await page.waitForTimeout(2500);
}

const browser = await launch();
for (const [name, width, height] of [["wide", 1280, 800], ["phone", 390, 844]]) {
  for (const colorScheme of ["light", "dark"]) {
    const { page, complaints } = await open(browser, pathToFileURL(resolve(file)).href, { viewport: { width, height }, colorScheme, reducedMotion: "reduce" });
    await put(page, 0.42);
    await page.screenshot({ path: `${folder}/${name}-${colorScheme}.png`, timeout: 120000 });
    const cards = page.locator(".cards").first();
    if (await cards.count()) {
      await cards.scrollIntoViewIfNeeded();
      await page.evaluate(() => document.querySelector(".cards").scrollIntoView());
      await put(page, 0.55);
      await page.screenshot({ path: `${folder}/${name}-${colorScheme}-cards.png`, timeout: 120000 });
    }
    if (complaints.length) console.log(name, colorScheme, complaints);
    await page.close();
  }
}
await browser.close();
