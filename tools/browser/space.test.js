// The page of `inspect`: the view isn't blank, a picked ray shows the numbers of rays.npz, drawing is fast.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { DESKTOP, PHONE, accessible, colors, folder, open, program } from "./browser.js";
import { npz } from "./npz.js";

/** Figures are those of an idle machine; a busy one may take so many times as long. */
const BUSY = 4;
/** First drawing of 100 cameras and 6,400 samples, in ms. */
const DRAWN = 1000;
/** Frames a second while the view is turned, drawn by the processor. */
const FRAMES = 20;

const out = folder();
const page = (name) => pathToFileURL(join(out, name, "index.html")).href;
const inspect = (scene, name, ...more) => program(["inspect", scene, "--out", join(out, name), ...more]);

/** Opens a page and waits for its first drawing. */
const opened = (name, look, options) =>
  open(page(name), async (page) => {
    await page.waitForFunction(() => document.documentElement.dataset.drawn, null, { timeout: 30_000 });
    return look(page);
  }, options);

/** Nothing but what WebGL draws: labels over it have colors and move, too. */
const bare = (page) => page.addStyleTag({ content: "#stage > :not(canvas) { display: none }" });

/** The definitions that a list shows. */
const facts = (page, id) =>
  page.evaluate((id) => Object.fromEntries([...document.querySelectorAll(`#${id} dt`)].map((name) => [name.textContent, name.nextSibling.textContent.trim()])), id);
const numbers = (text) => text.split(",").map(Number);

/** Seven digits are shown. */
function close(shown, expected, what) {
  assert.equal(shown.length, expected.length, what);
  shown.forEach((x, n) => assert.ok(Math.abs(x - expected[n]) <= 1e-6 * Math.abs(expected[n]), `${what}: ${x} is shown, ${expected[n]} is written`));
}

before(() => {
  inspect("builtin:spheres,views=96,size=32", "spheres");
  program(["train", "builtin:spheres,views=8,size=16", "--steps", "60", "--out", join(out, "trained")]);
  inspect("builtin:spheres,views=8,size=16", "run", "--run", join(out, "trained"), "--rays", "12", "--samples", "16");
});

/** All that the page says of ray r is what the arrays say. */
async function same(page, arrays, r) {
  const row = (name, wide) => arrays[name].values.slice(r * wide, (r + 1) * wide);
  const ray = await facts(page, "of-ray");
  close(numbers(ray.uv), row("rays_uv", 2), "uv");
  for (const [name, array] of [["o", "rays_o"], ["d", "rays_d"], ["photograph", "rays_rgb"], ["rendered", "colors"]]) {
    close(numbers(ray[name]), row(array, 3), name);
  }
  close([Number(ray["opacity A"])], row("opacities", 1), "A");
  const samples = arrays.t.shape[1];
  const table = await page.evaluate(() => [...document.querySelectorAll("#samples tr")].map((row) => [...row.cells].map((cell) => cell.textContent.trim())));
  assert.deepEqual(table[0], ["i", "t", "δ", "σ", "α", "T", "w", "color c"]);
  ["t", "deltas", "sigmas", "alphas", "transmittances", "weights"].forEach((name, column) => {
    close(table.slice(1).map((cells) => Number(cells[column + 1])), row(name, samples), name);
  });
  close(table.slice(1).flatMap((cells) => numbers(cells[7])), row("rgbs", 3 * samples), "color");
}

test("the view isn't blank, in light and in the dark, and layers can be hidden", async () => {
  for (const colorScheme of ["light", "dark"]) {
    await opened("spheres", async (page) => {
      await bare(page);
      const shown = await colors(page, "#view");
      assert.ok(shown > 500, `${shown} colors`);
      for (const box of await page.locator("#layers input").all()) await box.uncheck();
      await page.waitForTimeout(200);
      const hidden = await colors(page, "#view");
      assert.ok(hidden < shown / 2, `${shown} colors with all layers, ${hidden} with none`);
    }, { colorScheme });
  }
});

test("a ray from the list, and one that is clicked, show the numbers of rays.npz", async () => {
  for (const name of ["spheres", "run"]) {
    const arrays = npz(join(out, name, "rays.npz"));
    await opened(name, async (page) => {
      for (const r of [0, 7]) {
        await page.selectOption("#ray", String(r));
        await same(page, arrays, r);
      }
      // Rays alone: what is clicked in the middle of them is one of them.
      await page.locator("#layers input[name=cameras]").uncheck();
      const { width, height } = await page.locator("#view").boundingBox();
      for (let n = 0; n < 60 && (await page.inputValue("#ray")) === "7"; n++) {
        await page.locator("#view").click({ position: { x: width * (0.35 + 0.005 * n), y: height * (0.4 + 0.005 * n) } });
      }
      const picked = Number(await page.inputValue("#ray"));
      assert.notEqual(picked, 7, "no click picked another ray");
      await same(page, arrays, picked);
    });
  }
});

test("a trained run shows its occupied cells, and a camera is looked through", async () => {
  await opened("run", async (page) => {
    assert.equal(await page.locator("#layers input[name=cells]").count(), 1);
    await bare(page);
    const before = await page.locator("#view").screenshot();
    await page.selectOption("#camera", "3");
    assert.match((await facts(page, "of-camera")).frame, /^train\[3\]/);
    await page.click("#through");
    await page.waitForTimeout(200);
    assert.ok(!before.equals(await page.locator("#view").screenshot()), "the view stayed as it was");
  });
});

test("warnings are shown", async () => {
  // A circle of cameras whose z axes point inward: OpenGL's look along -z, away from one another.
  const scene = join(out, "turned.json");
  const poses = [0, 1.5, 3, 4.5].map((angle) => {
    const [s, c] = [Math.sin(angle), Math.cos(angle)];
    return [[-c, 0, -s, 4 * s], [0, 1, 0, 0], [s, 0, -c, 4 * c], [0, 0, 0, 1]];
  });
  const png = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR4nGP8z8DAwMDAxMDAwMDAAAANHQEDasKb6QAAAABJRU5ErkJggg==", "base64");
  writeFileSync(join(out, "p.png"), png);
  writeFileSync(scene, JSON.stringify({ camera_angle_x: 0.7, frames: poses.map((transform_matrix) => ({ file_path: "p.png", transform_matrix })) }));
  inspect(scene, "turned", "--near", "1", "--far", "3", "--rays", "4", "--samples", "4");
  await opened("turned", async (page) => {
    assert.match(await page.locator(".warnings").innerText(), /look away from the point that all axes pass closest to/);
  });
});

test("it is readable with a screen reader, on a phone, in the dark", async () => {
  for (const viewport of [DESKTOP, PHONE]) {
    for (const colorScheme of ["light", "dark"]) await opened("spheres", accessible, { viewport, colorScheme });
  }
});

test("keys turn and zoom", async () => {
  await opened("spheres", async (page) => {
    await bare(page);
    let last = await page.locator("#view").screenshot();
    for (const key of ["ArrowLeft", "ArrowUp", "+", "Home"]) {
      await page.locator("#view").press(key);
      await page.waitForTimeout(150);
      const next = await page.locator("#view").screenshot();
      assert.ok(!last.equals(next), `${key} changed nothing`);
      last = next;
    }
  });
});

test("it is drawn at once, and turns smoothly", async (context) => {
  const drawn = await opened("spheres", (page) => page.evaluate(() => Number(document.documentElement.dataset.drawn)));
  const turned = await opened("spheres", (page) =>
    page.evaluate(async () => {
      const view = document.getElementById("view");
      const gl = view.getContext("webgl2");
      const move = (type, x) => view.dispatchEvent(new PointerEvent(type, { pointerId: 1, buttons: 1, clientX: x, clientY: 300, bubbles: true }));
      const frame = () => new Promise((done) => requestAnimationFrame(done));
      move("pointerdown", 100);
      const start = performance.now();
      let frames = 0;
      for (; performance.now() - start < 3000; frames++) {
        move("pointermove", 100 + 5 * frames);
        await frame();
        // Until it is drawn, not only asked for.
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      }
      move("pointerup", 0);
      return (1000 * frames) / (performance.now() - start);
    }));
  context.diagnostic(`first drawing after ${drawn} ms; ${turned.toFixed(1)} frames a second`);
  assert.ok(drawn < BUSY * DRAWN, `first drawing after ${drawn} ms`);
  assert.ok(turned > FRAMES / BUSY, `${turned.toFixed(1)} frames a second`);
});

test("the page asks for nothing beside it", () => {
  const text = readFileSync(join(out, "spheres", "index.html"), "utf8");
  assert.ok(text.length < 5e6, `${text.length} bytes`);
  assert.doesNotMatch(text.replace(/<script type="text\/plain" id="three">[^]*?<\/script>/, ""), /(src|href)="(?!data:)/);
});
