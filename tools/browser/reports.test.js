// Reports load without errors, are readable on a phone and in the dark, and axe-core finds nothing serious.

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { DESKTOP, PHONE, accessible, folder, open, program } from "./browser.js";

/** Looks at a report on a desk and on a phone, in light and in the dark. */
async function readable(file) {
  for (const viewport of [DESKTOP, PHONE]) {
    for (const colorScheme of ["light", "dark"]) {
      await open(pathToFileURL(file).href, accessible, { viewport, colorScheme });
    }
  }
}

test("the demo's page", async () => {
  const out = join(folder(), "demo");
  program(["demo", "--seconds", "2", "--out", out]);
  await readable(join(out, "index.html"));
  await open(pathToFileURL(join(out, "index.html")).href, async (page) => {
    assert.ok((await page.locator("img").count()) > 0);
  });
});
