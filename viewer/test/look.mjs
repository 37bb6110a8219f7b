// node test/look.mjs PAGE.html FOLDER: pictures of a page, to be looked at.
import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launch, open } from "./browser.mjs";

const [file, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await launch();
for (const [name, width, height] of [["wide", 1280, 800], ["phone", 390, 844]]) {
  for (const colorScheme of ["light", "dark"]) {
    const { page, complaints } = await open(browser, pathToFileURL(resolve(file)).href, { viewport: { width, height }, colorScheme });
    await page.waitForTimeout(2500);
    await page.screenshot({ path: `${folder}/${name}-${colorScheme}.png` });
    const cards = page.locator("#primitives");
    if (await cards.count()) {
      await cards.scrollIntoViewIfNeeded();
      await page.evaluate(() => document.querySelector("#primitives").scrollIntoView());
      await page.waitForTimeout(2500);
      await page.screenshot({ path: `${folder}/${name}-${colorScheme}-cards.png` });
    }
    if (complaints.length) console.log(name, colorScheme, complaints);
    await page.close();
  }
}
await browser.close();
