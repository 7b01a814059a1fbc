// Live pages: a run is watched while it trains, and afterwards from its folder.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { test } from "node:test";
import { DESKTOP, PHONE, accessible, browser, folder, open, program } from "./browser.js";

/** Starts the program, and hands the address that it says to `look`; ends it afterwards, where it hasn't ended. */
async function serving(args, look) {
  const child = spawn(process.env.NERF_ORACLE, args, { stdio: ["ignore", "ignore", "pipe"] });
  const ended = once(child, "exit");
  try {
    const url = await new Promise((found, lost) => {
      const lines = createInterface({ input: child.stderr });
      lines.on("line", (line) => line.startsWith("see the run at ") && found(line.slice("see the run at ".length)));
      lines.on("close", () => lost(new Error(`${args.join(" ")} said no address`)));
    });
    return await look(url, ended);
  } finally {
    child.kill("SIGKILL");
    await ended;
  }
}

const data = (page, name) => page.locator("#stage").evaluate((stage, name) => Number(stage.dataset[name] ?? 0), name);
const shown = async (page, before = 0) => {
  await page.waitForFunction((before) => Number(document.getElementById("stage").dataset.views ?? 0) > before, before);
  return data(page, "views");
};
const view = (page) => page.locator("#view").screenshot().then((png) => png.toString("base64"));

async function drag(page) {
  await page.locator("#stage").evaluate((stage) => stage.scrollIntoView({ block: "center" }));
  const box = await page.locator("#stage").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  for (let n = 1; n <= 10; n++) {
    await page.mouse.move(box.x + box.width / 2 + 12 * n, box.y + box.height / 2 - 4 * n);
    await page.waitForTimeout(40);
  }
  await page.mouse.up();
}

const SCENE = ["builtin:spheres,size=64"];

test("a page follows the training, and knows all of it after a reload", async () => {
  const run = join(folder(), "run");
  await serving(["train", ...SCENE, "--out", run, "--seconds", "45", "--val-every", "200", "--serve", "0"], async (url) => {
    await open(url, async (page) => {
      const step = () => page.evaluate(() => Number(document.body.dataset.step ?? 0));
      await page.waitForFunction(() => Number(document.body.dataset.step ?? 0) > 20);
      const first = await step();
      await page.waitForFunction((first) => Number(document.body.dataset.step) > first, first);
      await shown(page);
      await page.waitForFunction(() => document.querySelectorAll(".views").length > 0, null, { timeout: 60000 });
      assert.match(await page.locator("#left").textContent(), /^0:\d\d$/);
      const loaded = await page.locator("#curve").evaluate((picture) => picture.complete && picture.naturalWidth);
      assert.ok(loaded > 0, "the curve is drawn");
      const before = await step();
      await page.reload();
      await page.waitForFunction((before) => Number(document.body.dataset.step ?? 0) >= before, before);
      await page.waitForFunction(() => document.querySelectorAll(".views").length > 0);
      await shown(page);
      const views = await shown(page, 0);
      await drag(page);
      await shown(page, views);
      assert.ok((await data(page, "step")) > 0, "the view is of a trained model");
    }, { from: url });
  });
});

test("a run is turned, kept as keys, and rendered through them", async () => {
  const out = folder();
  const run = join(out, "run");
  program(["train", ...SCENE, "--out", run, "--seconds", "4", "--quiet"]);
  await serving(["view", run, "--port", "0"], async (url) => {
    for (const viewport of [DESKTOP, PHONE]) {
      for (const colorScheme of ["light", "dark"]) {
        await open(url, async (page) => {
          await shown(page);
          await page.waitForFunction(() => document.querySelectorAll(".views").length > 0);
          await accessible(page);
        }, { viewport, colorScheme, from: url });
      }
    }
    await open(url, async (page) => {
      let views = await shown(page);
      const first = await view(page);
      await page.click("#keep");
      await drag(page);
      views = await shown(page, views);
      await page.waitForFunction(() => document.getElementById("stage").dataset.moving === "false");
      assert.equal(await data(page, "width"), 64, "all pixels once it is still");
      const turned = await view(page);
      assert.notEqual(first, turned);
      await page.focus("#stage");
      views = await data(page, "views");
      await page.keyboard.press("ArrowLeft");
      await page.keyboard.press("+");
      await shown(page, views);
      await page.click("#keep");
      for (const act of [() => page.check("#depth"), () => page.uncheck("#depth"), () => page.selectOption("#background", "1,1,1")]) {
        views = await data(page, "views");
        await page.waitForTimeout(400);
        const before = await view(page);
        views = await data(page, "views");
        await act();
        await shown(page, views);
        assert.notEqual(await view(page), before);
      }
      await page.waitForFunction(() => document.getElementById("keys").textContent.startsWith("2 keys"));
      const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
      const keys = JSON.parse(readFileSync(await download.path(), "utf8"));
      assert.equal(keys.frames.length, 2);
      writeFileSync(join(out, "keys.json"), JSON.stringify(keys));
      await page.reload();
      await page.waitForFunction(() => document.getElementById("keys").textContent.startsWith("2 keys"));
    }, { from: url });
    const film = JSON.parse(program(["render", run, "--out", join(out, "film.png"), "--path", `${join(out, "keys.json")}:3`, "--json"]));
    assert.equal(film.frames, 3);
  });
});

test("the page of another site gets nothing", async () => {
  const run = join(folder(), "run");
  program(["train", ...SCENE, "--out", run, "--steps", "2", "--quiet"]);
  await serving(["view", run, "--port", "0"], async (url) => {
    const foreign = await fetch(url, { headers: { origin: "http://evil.example" } });
    assert.equal(foreign.status, 403);
    const load = (url) => new Promise((told) => {
      const picture = new Image();
      Object.assign(picture, { onload: () => told("loaded"), onerror: () => told("refused"), src: `${url}photographs/0` });
    });
    const read = (url) => fetch(`${url}api/state`).then((answer) => answer.status, () => "refused");
    const page = await (await browser()).newPage();
    try {
      // A page of nobody's, which has no policy of its own.
      assert.equal(await page.evaluate(load, url), "refused");
      assert.equal(await page.evaluate(read, url), "refused");
      await page.goto(url);
      assert.equal(await page.evaluate(load, url), "loaded");
      assert.equal(await page.evaluate(read, url), 200);
    } finally {
      await page.close();
    }
  });
});
