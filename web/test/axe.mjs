// The rules of WCAG 2.2 AA, as axe-core checks them.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const axe = readFileSync(createRequire(join(process.cwd(), "package.json")).resolve("axe-core/axe.min.js"), "utf8");

/** What axe finds, a line each. @param rules  of these names alone; all of WCAG and what mends cheaply otherwise */
export async function violations(page, rules = null) {
  if (!(await page.evaluate(() => Boolean(window.axe)))) await page.evaluate(axe);
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
