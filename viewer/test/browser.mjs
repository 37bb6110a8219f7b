// A browser without a screen, and the page in it.
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const PLACES = [process.env.KINEME_CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const FLAGS = [
  "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
];

export const executablePath = PLACES.find((place) => place && existsSync(place));

export function launch() {
  return chromium.launch({ executablePath, args: FLAGS, headless: true });
}

/** The page of a file, with what it complained of and what it tried to load. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  const loads = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !/GPU stall|swiftshader|WebGL.*performance/i.test(message.text())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (request.url() !== url) loads.push(request.url());
  });
  await page.goto(url, { timeout: 120000 });
  return { page, complaints, loads };
}

/** Waits until the page finds `there` true. The page's policy forbids what playwright's own waiting does. */
export async function until(page, there, argument, ms = 60000) {
  const end = Date.now() + ms;
  for (;;) {
    const found = await page.evaluate(there, argument);
    if (found) return found;
    if (Date.now() > end) throw new Error(`waited ${ms} ms in vain: ${there}`);
    await page.waitForTimeout(50);
  }
}

/** Does something and waits until the canvas shows a picture that knows of it: one drawn after the first `input` or `click`
 * came of it. A picture may be drawn anew at any time, sharper or less sharp, so what was counted earlier tells nothing. */
export async function redrawn(page, selector, act) {
  await page.evaluate((selector) => {
    const canvas = document.querySelector(selector);
    delete canvas.dataset.before;
    const first = new AbortController();
    for (const event of ["input", "click"]) {
      document.addEventListener(event, () => {
        canvas.dataset.before = canvas.dataset.drawn ?? "0";
        first.abort();
      }, { capture: true, signal: first.signal });
    }
  }, selector);
  await act();
  await until(page, (selector) => {
    const { before, drawn } = document.querySelector(selector).dataset;
    return before !== undefined && Number(drawn) > Number(before);
  }, selector);
}
