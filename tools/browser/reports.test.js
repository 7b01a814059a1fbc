// Reports load without errors, are readable on a phone and in the dark, and axe-core finds nothing serious.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { DESKTOP, PHONE, accessible, folder, open, program } from "./browser.js";

const out = folder();
const at = (...parts) => join(out, ...parts);
const SCENE = "builtin:spheres,views=8,size=32";

before(() => {
  program(["train", SCENE, "--steps", "120", "--out", at("run")]);
  program(["evaluate", at("run"), "--out", at("evaluated")]);
});

/** Looks at a report on a desk and on a phone, in light and in the dark; all of its pictures are there, and it is small. */
async function readable(file, check = async () => {}) {
  assert.ok(statSync(file).size < 5e6, `${statSync(file).size} bytes`);
  for (const viewport of [DESKTOP, PHONE]) {
    for (const colorScheme of ["light", "dark"]) {
      await open(pathToFileURL(file).href, async (page) => {
        for (const picture of await page.locator("img").all()) await picture.scrollIntoViewIfNeeded();
        await page.waitForFunction(() => [...document.images].every((picture) => picture.complete));
        const missing = await page.evaluate(() => [...document.images].filter((picture) => !picture.naturalWidth || !picture.alt).map((picture) => picture.src));
        assert.deepEqual(missing, []);
        await accessible(page);
        await check(page);
      }, { viewport, colorScheme });
    }
  }
}

/** View names and PSNRs, in the order in which the page shows them. */
const shown = (page) => page.evaluate(() => [...document.querySelectorAll("h3")].map((heading) => Number(heading.textContent.match(/: ([\d.]+) dB/)[1])));

test("a run's page: the last views of the log, the worst first", async () => {
  const log = readFileSync(at("run", "log.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
  const last = log.findLast((point) => point.val_psnr !== null);
  await readable(at("run", "index.html"), async (page) => {
    const psnr = await shown(page);
    assert.equal(psnr.length, last.val_views);
    assert.deepEqual(psnr, psnr.toSorted((a, b) => a - b));
    const mean = psnr.reduce((sum, x) => sum + x, 0) / psnr.length;
    // The views are files of bytes, the log knows them as floats.
    assert.ok(Math.abs(mean - last.val_psnr) < 0.05, `${mean} on the page, ${last.val_psnr} in the log`);
    assert.equal(await page.locator("img").count(), 1 + 3 * psnr.length);
  });
});

test("an evaluation's page: the scores that the program says", async () => {
  const scores = JSON.parse(program(["evaluate", at("run"), "--json"]));
  await readable(at("evaluated", "index.html"), async (page) => {
    const expected = scores.views.map((view) => Number(view.psnr.toFixed(2))).toSorted((a, b) => a - b);
    assert.deepEqual(await shown(page), expected);
    assert.match(await page.locator("main").innerText(), new RegExp(scores.ssim.toFixed(4)));
  });
});

test("the judge's page: the verdict, the diagnosis, where it is wrong, the case by hand", async () => {
  const [cases, answers] = [at("cases"), at("answers")];
  program(["cases", "volume_render", "--layout", "raw", "--dtype", "f32", "--out", cases]);
  // The example with its mistake: each sample shades itself.
  const example = fileURLToPath(new URL("../examples/js/volume_render.mjs", import.meta.url));
  execFileSync(process.execPath, [example, cases, answers, "inclusive"]);
  program(["judge", cases, answers, "--out", at("judged")], 1);
  await readable(at("judged", "index.html"), async (page) => {
    assert.equal(await page.locator("td.fail").first().innerText(), "fail");
    const text = await page.locator("main").innerText();
    for (const said of [/consistent with: inclusive_transmittance/, /the smallest case that is wrong/, /Where (colors|weights) is wrong, in case/]) assert.match(text, said);
    assert.ok((await page.locator("figure svg rect").count()) > 4);
  });
});

test("other pages: a sweep, a fitted picture, a benchmark", async () => {
  program(["sweep-image", "builtin:card", "--size", "24", "--levels", "2,4", "--width", "16", "--lr", "1e-2", "--steps", "20", "--out", at("sweep")]);
  program(["fit-image", "builtin:card", "--size", "24", "--steps", "40", "--width", "16", "--out", at("fit")]);
  program(["bench", "spherical_harmonics", "--quick", "--out", at("bench")]);
  for (const name of ["sweep", "fit", "bench"]) await readable(at(name, "index.html"));
  await open(pathToFileURL(at("fit", "psnr.svg")).href, async () => {});
});

test("charts can be read in the dark", async () => {
  await open(pathToFileURL(at("run", "psnr.svg")).href, async (page) => {
    const [ink, paper] = await page.evaluate(() => {
      const { color, backgroundColor } = getComputedStyle(document.documentElement);
      return [color, backgroundColor].map((text) => Number(text.match(/\d+/)[0]));
    });
    assert.ok(ink > 180 && paper < 60, `ink ${ink} on paper ${paper}`);
  }, { colorScheme: "dark" });
});
