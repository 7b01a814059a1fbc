// What every test of a page needs: the program, a browser, and what a page must never do.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { chromium } from "playwright-core";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

// Nothing that the browser does by itself goes to the network; WebGL is drawn by the processor.
const ARGUMENTS = [
  "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];

export const DESKTOP = { width: 1280, height: 800 };
export const PHONE = { width: 390, height: 844 };

/** A folder that is removed when the test file has ended. */
export function folder() {
  const path = mkdtempSync(join(tmpdir(), "nerf-oracle-pages-"));
  after(() => rmSync(path, { recursive: true, force: true }));
  return path;
}

/** Runs the program; exit codes other than `code` fail. Its stdout. */
export function program(args, code = 0) {
  try {
    const out = execFileSync(process.env.NERF_ORACLE, args, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
    assert.equal(code, 0, `${args.join(" ")}: exit code 0`);
    return out;
  } catch (error) {
    if (error.status !== code) throw new Error(`${args.join(" ")}: exit code ${error.status}\n${error.stderr}`);
    return error.stdout;
  }
}

let started;

/** The browser of this test file. */
export function browser() {
  started ??= chromium.launch({ executablePath: process.env.CHROMIUM, headless: true, args: ARGUMENTS });
  return started;
}
after(async () => (await started)?.close());

/**
 * Opens a page and hands it to `look`. Whatever the page says on the console as an error, throws, or fails to load fails the test, as
 * does a request to anywhere but `from`. A request that a reload breaks off, as a poll under way may be, is no failure.
 */
export async function open(url, look, { viewport = DESKTOP, colorScheme = "light", from = "file://" } = {}) {
  const context = await (await browser()).newContext({ viewport, colorScheme });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (message) => message.type() === "error" && wrong.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => wrong.push(`thrown: ${error.message}`));
  page.on("requestfailed", (request) => {
    const { errorText } = request.failure();
    if (errorText !== "net::ERR_ABORTED") wrong.push(`not loaded: ${request.url().slice(0, 200)}: ${errorText}`);
  });
  page.on("request", (request) => {
    const { protocol } = new URL(request.url());
    const here = ["data:", "blob:"].includes(protocol) || request.url().startsWith(from);
    if (!here) wrong.push(`asked for ${request.url()}`);
  });
  try {
    await page.goto(url);
    const seen = await look(page);
    assert.deepEqual(wrong, []);
    return seen;
  } finally {
    await context.close();
  }
}

/** Fails on whatever axe-core finds serious or critical, on anything wider than the screen, and on pictures without a text. */
export async function accessible(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  const serious = violations.filter((found) => ["serious", "critical"].includes(found.impact));
  assert.deepEqual(serious.map((found) => `${found.id}: ${found.nodes.map((node) => node.html.slice(0, 120)).join(" | ")}`), []);
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= screen, `the page is ${wide} pixels wide, the screen ${screen}`);
}

/** How many colors the element shows. */
export async function colors(page, selector) {
  const png = await page.locator(selector).screenshot();
  return page.evaluate(async (base64) => {
    const picture = new Image();
    picture.src = `data:image/png;base64,${base64}`;
    await picture.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [picture.width, picture.height];
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    return new Set(pixels).size;
  }, png.toString("base64"));
}
