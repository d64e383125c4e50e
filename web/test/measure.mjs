// How soon a page answers, and how many pictures a second it draws: scripts/test-page --measure, on a machine that does
// nothing else. Prints the medians of five, with the range.
import { join } from "node:path";
import { Browser } from "./browser.mjs";

const ROUNDS = 5;
const PLAYED = 3000; // ms
const pages = ["compare.html", "walk.html", "verdict.html"];
const browser = new Browser(/^(file|data|blob):/);

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const said = (values, digits) =>
  `${median(values).toFixed(digits)} (${Math.min(...values).toFixed(digits)} to ${Math.max(...values).toFixed(digits)})`;

/** From the address until a click is answered: the page has run its script, drawn, and has nothing left to do. */
async function readyAfter(page) {
  return page.evaluate(
    () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(() => resolve(performance.now() / 1000), 0))),
  );
}

/** Pictures of the robot that are drawn while it plays. */
async function pictures(page) {
  return page.evaluate(
    (time) =>
      new Promise((resolve) => {
        const { view, player } = window.crossgait;
        let drawn = 0;
        const render = view.renderer.render.bind(view.renderer);
        view.renderer.render = (...of) => (++drawn, render(...of));
        const begin = performance.now();
        player.toggle();
        setTimeout(() => {
          player.toggle();
          resolve((1000 * drawn) / (performance.now() - begin));
        }, time);
      }),
    PLAYED,
  );
}

await browser.launch();
try {
  for (const name of pages) {
    const ready = [];
    const rates = [];
    for (let i = 0; i < ROUNDS; ++i) {
      const { page } = await browser.open(`file://${join(process.env.PAGES, name)}`);
      ready.push(await readyAfter(page));
      if (await page.evaluate(() => Boolean(window.crossgait.player))) rates.push(await pictures(page));
      await page.close();
    }
    console.log(
      `${name}: answers after ${said(ready, 2)} s${rates.length > 0 ? `, plays at ${said(rates, 0)} pictures/s` : ""}`,
    );
  }
} finally {
  await browser.close();
}
