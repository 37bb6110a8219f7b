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
  await page.goto(url);
  return { page, complaints, loads };
}
