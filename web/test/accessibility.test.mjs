// Who cannot see the page, or has no mouse: rules of WCAG 2.2 AA as axe-core checks them (contrast, names of controls, heads
// of tables, places that scroll), light and dark, and every control by the tabulator key.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { violations } from "./axe.mjs";
import { Browser, withoutPicture, WITHOUT_PICTURE } from "./browser.mjs";

const browser = new Browser(/^(file|data|blob):/, WITHOUT_PICTURE);

before(() => browser.launch());
after(() => browser.close());

const open = (name, before_) => browser.open(`file://${join(process.env.PAGES, name)}`, { before: before_ });

for (const name of ["compare", "diagnosis", "course", "verdict", "many", "workspace"]) {
  test(`${name}.html keeps the rules of WCAG, light and dark`, async () => {
    const { page } = await open(`${name}.html`, name === "compare" ? null : withoutPicture);
    await page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));
    assert.deepEqual(await violations(page), []);
    await page.keyboard.press("t");
    assert.deepEqual(await violations(page, ["color-contrast"]), [], "dark");
    await page.setViewportSize({ width: 390, height: 800 });
    assert.deepEqual(await violations(page, ["scrollable-region-focusable", "target-size"]), [], "on a phone");
    await page.close();
  });
}

test("the checks see what is wrong", async () => {
  const { page } = await open("verdict.html", withoutPicture);
  await page.evaluate(() => {
    for (const name of ["aria-label", "title"]) document.querySelector("header button").removeAttribute(name);
    document.querySelector("header button").replaceChildren();
    document.querySelector("h1").style.color = "#ccc";
    document.querySelector("thead th").replaceChildren();
  });
  const rules = new Set((await violations(page)).map((line) => line.split(":")[0]));
  for (const rule of ["button-name", "color-contrast", "empty-table-header"])
    assert.ok(rules.has(rule), `${rule} among ${[...rules]}`);
  await page.close();
});

test("the tabulator key reaches every control", async () => {
  const { page } = await open("diagnosis.html", null);
  const controls = await page.evaluate(() => {
    const all = [...document.querySelectorAll("button, input, select, summary, canvas[tabindex]")];
    return all.filter((e) => e.offsetParent && !e.disabled).map((e, i) => ((e.dataset.control = i), i)).length;
  });
  const reached = new Set();
  for (let i = 0; i < 2 * controls + 20; ++i) {
    await page.keyboard.press("Tab");
    const control = await page.evaluate(() => document.activeElement.dataset.control);
    if (control !== undefined) reached.add(control);
  }
  assert.equal(reached.size, controls);
  await page.close();
});
