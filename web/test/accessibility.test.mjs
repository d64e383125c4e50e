// Who cannot see the page, or has no mouse: rules of WCAG 2.2 AA as axe-core checks them (contrast, names of controls, heads
// of tables, places that scroll), light and dark, and every control by the tabulator key.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Browser } from "./browser.mjs";

const axe = readFileSync(createRequire(join(process.cwd(), "package.json")).resolve("axe-core/axe.min.js"), "utf8");
// A picture by software takes a second each; what is around it is the same without.
const withoutPicture = () => {
  const real = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return /webgl/.test(kind) ? null : real.call(this, kind, ...rest);
  };
};
const browser = new Browser(/^(file|data|blob):/, ["creating WebGL context"]);

before(() => browser.launch());
after(() => browser.close());

const open = (name, before_) => browser.open(`file://${join(process.env.PAGES, name)}`, { before: before_ });

/** What axe finds, a line each. @param rules  of these names alone; all of WCAG and what mends cheaply otherwise */
function violations(page, rules = null) {
  return page.evaluate(async (only) => {
    const tags = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
    const runOnly = only ? { type: "rule", values: only } : { type: "tag", values: tags };
    const found = await window.axe.run(document, {
      runOnly,
      resultTypes: ["violations"],
      rules: only ? {} : { "label-content-name-mismatch": { enabled: true } },
    });
    return found.violations.flatMap((v) => v.nodes.map((node) => `${v.id}: ${node.target}: ${node.failureSummary}`));
  }, rules);
}

for (const name of ["compare", "diagnosis", "course", "verdict", "many", "workspace"]) {
  test(`${name}.html keeps the rules of WCAG, light and dark`, async () => {
    const { page } = await open(`${name}.html`, name === "compare" ? null : withoutPicture);
    await page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));
    await page.evaluate(axe);
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
  await page.evaluate(axe);
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
