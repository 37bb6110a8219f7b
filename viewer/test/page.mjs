// node test/page.mjs PAGE.html: the page of made-up movement in a real browser. Fails on the first thing that is wrong.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { executablePath, launch, open, redrawn, until } from "./browser.mjs";

const STAGE = "#stage canvas";
const CARD = ".card canvas";

if (!executablePath) {
  console.log("SKIPPED: no Chromium here (Debian: apt install chromium; or KINEME_CHROMIUM names one)");
  process.exit(0);
}
const url = pathToFileURL(resolve(process.argv[2])).href;
const browser = await launch();

/** Opens the page where nothing moves by itself, waits for its first picture, and closes it after the checks. */
async function check(law, checks, options = {}) {
  const { page, complaints, loads } = await open(browser, url, { reducedMotion: "reduce", ...options });
  page.setDefaultTimeout(60000);
  await until(page, () => document.querySelector("#stage canvas")?.dataset.drawn !== undefined);
  await checks(page, { complaints, loads });
  await page.context().close();
  console.log(`ok: ${law}`);
}

/** A sum that tells pictures apart, how many pixels are painted, and how many colours there are. */
const picture = (page, selector) => page.evaluate((selector) => {
  const canvas = document.querySelector(selector);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let sum = 0;
  let painted = 0;
  const colours = new Set();
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] > 200) painted += 1;
    colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    sum = (31 * sum + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000003;
  }
  return { sum, painted, colours: colours.size };
}, selector);

const time = (page) => page.evaluate(() => document.querySelector("#stage .time").textContent);

const slide = (page, selector, value) => page.evaluate(([selector, value]) => {
  const slider = document.querySelector(selector);
  slider.value = String(value);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}, [selector, value]);

const atCards = async (page) => {
  await page.evaluate(() => document.querySelector(".cards").scrollIntoView());
  await until(page, () => document.querySelector(".card canvas")?.dataset.drawn !== undefined);
};

await check("the page loads alone, complains of nothing, and shows bodies", async (page, { complaints, loads }) => {
  const seen = await picture(page, STAGE);
  assert.ok(seen.painted > 2000 && seen.colours > 50, JSON.stringify(seen));
  await atCards(page);
  assert.deepEqual(complaints, []);
  assert.deepEqual(loads, []);
});

await check("the time line scrubs: time and picture change", async (page) => {
  const before = [await time(page), (await picture(page, STAGE)).sum];
  await redrawn(page, STAGE, () => slide(page, "#stage .scrub", 2));
  assert.equal(await time(page), "2.00 / 6.00 s");
  assert.notEqual((await picture(page, STAGE)).sum, before[1]);
  const { x, y, width } = await page.locator(".lane").first().boundingBox();
  await page.mouse.click(x + width / 2, y + 10);
  assert.match(await time(page), /^(2\.9|3\.0)/);
  assert.match(await page.locator(".track-now").first().textContent(), /wave-\d \d+ %/);
});

await check("keys play, step, jump and change the speed", async (page) => {
  await page.locator("#stage .viewport").focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await time(page), /^0\.03/);
  await page.keyboard.press("End");
  assert.match(await time(page), /^6\.00/);
  await page.keyboard.press("Home");
  assert.match(await time(page), /^0\.00/);
  await page.keyboard.press("-");
  assert.equal(await page.locator("#stage [aria-label=Speed]").inputValue(), "0.5");
  await page.keyboard.press("+");
  assert.equal(await page.locator("#stage .play").getAttribute("aria-label"), "Play");
  await page.keyboard.press(" ");
  await until(page, () => !document.querySelector("#stage .time").textContent.startsWith("0.00"));
  await page.keyboard.press(" ");
  assert.equal(await page.locator("#stage .play").getAttribute("aria-label"), "Play");
});

await check("a slider changes posture and duration, the flowfield can be seen", async (page) => {
  await atCards(page);
  await redrawn(page, CARD, () => slide(page, ".card .scrub", 0.5));
  const before = await picture(page, CARD);
  const lasted = await page.locator(".card .time").first().textContent();
  await redrawn(page, CARD, () => slide(page, ".card .parameter input", 2.7));
  const after = await picture(page, CARD);
  assert.notEqual(after.sum, before.sum);
  assert.notEqual(await page.locator(".card .time").first().textContent(), lasted);
  assert.equal(await page.locator(".card .parameter output").first().textContent(), "2.70 m");
  await redrawn(page, CARD, () => page.locator('[aria-label="Show the flowfield"]').first().click());
  assert.notEqual((await picture(page, CARD)).sum, after.sum);
});

await check("an exemplar's source plays on the stage from its beginning", async (page) => {
  await page.locator(".card summary").first().click();
  await page.locator(".card a[data-take]").first().click();
  assert.match(await time(page), /^1\.50/);
  assert.ok(await page.locator(".choice input").nth(1).isChecked());
  const top = await page.evaluate(() => document.querySelector("#stage").getBoundingClientRect().top);
  assert.ok(Math.abs(top) < 40, `${top}`);
  await page.keyboard.press("n");
  assert.ok(await page.locator(".choice input").first().isChecked());
});

await check("names become a command, and come back", async (page) => {
  await atCards(page);
  const bar = page.locator(".edits");
  assert.ok(await bar.isHidden());
  await page.locator(".name").first().fill("hello, = there");
  assert.equal(await bar.locator("code").textContent(), "kineme edit 'made up.kineme' -o 'made up-edited.kineme' --rename 'wave=hello- - there'");
  await page.locator(".remove").nth(1).click();
  assert.match(await bar.locator("code").textContent(), /--remove '<wave> too'$/);
  await bar.locator("button").last().click();
  assert.ok(await bar.isHidden());
  assert.equal(await page.locator(".name").first().inputValue(), "wave");
});

await check("all of a body is seen at its widest and at its highest, beside what it is compared with", async (page) => {
  await atCards(page);
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    await redrawn(page, CARD, () => slide(page, ".card .scrub", share === 0 ? 0.01 : share * 1.1));
    // Every wall of the picture is free of strong colour; the floor's lines are grey.
    const touched = await page.evaluate(() => {
      const canvas = document.querySelector(".card canvas");
      const { width, height } = canvas;
      const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
      let found = 0;
      for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
          if (x > 1 && y > 1 && x < width - 2 && y < height - 2) continue;
          const [r, g, b, a] = data.subarray(4 * (y * width + x));
          if (a > 150 && Math.max(r, g, b) - Math.min(r, g, b) > 60) found += 1;
        }
      }
      return found;
    });
    assert.equal(touched, 0, `at ${share}`);
  }
});

await check("the contents lead to their sections", async (page) => {
  await page.locator("nav a").last().click();
  const [place, top] = await page.evaluate(() => [location.hash, document.querySelector("#section-1").getBoundingClientRect().top]);
  assert.equal(place, "#section-1");
  assert.ok(top >= 0 && top < 800, `${top}`);
});

await check("another take can be chosen, a body hidden", async (page) => {
  const before = (await picture(page, STAGE)).sum;
  await redrawn(page, STAGE, () => page.locator(".legend input").last().click());
  assert.notEqual((await picture(page, STAGE)).sum, before);
  await redrawn(page, STAGE, () => page.locator(".choice label").nth(1).click());
  assert.equal(await page.locator(".track").count(), 0);
});

await check("at a phone's width nothing sticks out", async (page) => {
  await atCards(page);
  const [content, room] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(content <= room, `${content} of ${room}`);
}, { viewport: { width: 390, height: 844 } });

await check("dark is dark", async (page) => {
  const [paper, picture] = await page.evaluate(() => {
    const style = (element) => getComputedStyle(element);
    return [style(document.body).backgroundColor, style(document.querySelector(".viewport")).backgroundImage];
  });
  assert.equal(paper, "rgb(21, 24, 28)");
  assert.match(picture, /rgb\(39, 45, 52\)/);
}, { colorScheme: "dark" });

await check("without leave to move nothing moves by itself; else it plays", async (page) => {
  assert.match(await time(page), /^0\.00/);
});
await check("what may move plays", async (page) => {
  await until(page, () => !document.querySelector("#stage .time").textContent.startsWith("0.00"));
}, { reducedMotion: "no-preference" });

await browser.close();
