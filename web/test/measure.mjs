// How soon a page answers, and how many pictures a second it draws: scripts/test-page --measure [PAGE.html...], on a machine
// that does nothing else. Prints the medians of five, with the range. PAGEs are replays beside those of the tests.
import { join, resolve as absolute } from "node:path";
import { Browser } from "./browser.mjs";

const ROUNDS = 5;
const PLAYED = 10_000; // ms
const WINDOW = { width: 1280, height: 720 };
const pages = ["compare.html", "walk.html", "verdict.html"].map((name) => join(process.env.PAGES, name));
pages.push(...process.argv.slice(2).map((path) => absolute(process.env.FROM ?? ".", path)));
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

/** The picture over the whole window. */
async function fill(page) {
  await page.evaluate(({ width, height }) => {
    const { style } = document.querySelector(".canvas");
    const sizes = { width: `${width}px`, height: `${height}px`, maxHeight: "none", aspectRatio: "auto" };
    Object.assign(style, { position: "fixed", inset: 0, zIndex: 9, ...sizes });
  }, WINDOW);
}

/** Pictures a second while it plays: of the median time from one to the next. */
async function pictures(page) {
  return page.evaluate(
    (time) =>
      new Promise((resolve) => {
        const { view, player } = window.crossgait;
        const drawn = [];
        const render = view.renderer.render.bind(view.renderer);
        view.renderer.render = (...of) => (drawn.push(performance.now()), render(...of));
        player.seek(player.begin);
        player.toggle();
        setTimeout(() => {
          if (player.playing) player.toggle();
          const times = drawn.slice(1).map((at, i) => at - drawn[i]);
          resolve(1000 / times.sort((a, b) => a - b)[Math.floor(times.length / 2)]);
        }, time);
      }),
    PLAYED,
  );
}

await browser.launch();
try {
  for (const path of pages) {
    const ready = [];
    const rates = { "as it is": [], "as large as the window": [] };
    for (let i = 0; i < ROUNDS; ++i) {
      const { page } = await browser.open(`file://${path}`);
      ready.push(await readyAfter(page));
      await page.setViewportSize(WINDOW);
      if (await page.evaluate(() => Boolean(window.crossgait.player))) {
        for (const own of Object.values(rates)) {
          if (own === rates["as large as the window"]) await fill(page);
          await page.waitForTimeout(1000);
          own.push(await pictures(page));
        }
      }
      await page.close();
    }
    console.log(`${path}: answers after ${said(ready, 2)} s`);
    for (const [how, own] of Object.entries(rates)) {
      if (own.length > 0) console.log(`  its picture ${how}: ${said(own, 0)} pictures/s`);
    }
  }
} finally {
  await browser.close();
}
