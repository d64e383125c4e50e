// The page in a real browser: node --test test/*.test.mjs, with the pages that scripts/test-page has written in $PAGES.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Browser, withoutPicture } from "./browser.mjs";

const pages = process.env.PAGES;
const browser = new Browser(/^(file|data|blob):/);

before(() => browser.launch());
after(() => browser.close());

const open = (name, options) => browser.open(`file://${join(pages, name)}`, options);

/** Rows of a trace as objects. */
function readTrace(name) {
  const [head, ...lines] = readFileSync(join(pages, name), "utf8").trim().split("\n");
  const names = head.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((cell, i) => [names[i], Number(cell)])));
}

/** As the page writes what commands print. */
const typeset = (text) => text.replaceAll("+-", "\u00b1").replace(/(^|[\s(,;:]|\de)-(?=[\d.])/g, "$1\u2212");

const time = (page) => page.evaluate(() => window.crossgait.player.time);
const cursors = (page) =>
  page.evaluate(() => window.crossgait.plots.all.filter((p) => p.visible).map((p) => p.cursorTime));

async function expectCursorsAt(page, at) {
  const found = await cursors(page);
  assert.ok(found.length >= 3, "plots are there");
  // A pixel of the narrowest plot: 5 s over 230 of them.
  for (const t of found) assert.ok(Math.abs(t - at) < 0.03, `cursor at ${t} s, replay at ${at} s`);
}

test("a comparison of three engines loads, small and soon", async () => {
  assert.ok(statSync(join(pages, "compare.html")).size <= 3e6, "at most 3 MB for 5 s");
  const { page, problems } = await open("compare.html");
  assert.match(await page.title(), /trot on rough/);
  assert.equal(await page.evaluate(() => window.crossgait.view.robots.length), 3);
  const pixels = await page.evaluate(() => {
    const { canvas } = window.crossgait.view;
    window.crossgait.view.drawNow();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [64, 64];
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0, 64, 64);
    return new Set(new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer)).size;
  });
  assert.ok(pixels > 100, `a picture of ${pixels} colours`);
  // Every plot is drawn, also those that nobody has scrolled to.
  const drawn = await page.evaluate(() => {
    const shown = window.crossgait.plots.all.filter((p) => p.element.offsetParent);
    for (const plot of shown) plot.ensure();
    return [shown.length, document.querySelectorAll(".plots .plot canvas").length];
  });
  await page.waitForTimeout(200);
  assert.ok(drawn[0] >= 18 && drawn[1] === drawn[0], `${drawn[1]} of ${drawn[0]} plots`);
  await page.evaluate(() => window.crossgait.player.seek(2));
  await page.evaluate(() =>
    document.querySelectorAll(".plots .panel:not([hidden])").forEach((panel) => panel.scrollIntoView()),
  );
  await page.waitForFunction(() =>
    window.crossgait.plots.all.some((p) => p.visible && p.panel?.group === "differences"),
  );
  await expectCursorsAt(page, 2);
  assert.deepEqual(problems, []);
  await page.close();
});

test("feet are where the trace has them", async () => {
  const { page, problems } = await open("walk.html");
  const trace = readTrace("walk.csv");
  for (const row of [0, 500, 1235, trace.length - 1]) {
    const at = trace[row];
    const shown = await page.evaluate((t) => {
      const { player, view, runs } = window.crossgait;
      player.playing = false;
      player.seek(t);
      const robot = view.robots[0];
      const frame = runs[0].frameAt(t);
      const place = (object) => object.getWorldPosition(object.position.clone()).toArray();
      return {
        time: runs[0].time[frame],
        base: place(robot.bodies[0]),
        feet: robot.feet.map(place),
        said: Array.from(runs[0].feet.subarray(12 * frame, 12 * frame + 12)),
      };
    }, at.time);
    const near = trace.reduce((a, b) => (Math.abs(b.time - shown.time) < Math.abs(a.time - shown.time) ? b : a));
    assert.ok(Math.abs(near.time - at.time) <= 0.0101, "a frame every hundredth of a second");
    ["x", "y", "z"].forEach((axis, i) => assert.ok(Math.abs(shown.base[i] - near[`p_WB.${axis}`]) < 1e-5, "base"));
    // Bodies come from poses, feet from the feet of the trace: two ways to one place. 1e-4 m is what nobody sees.
    shown.feet.forEach((foot, leg) =>
      foot.forEach((value, i) => assert.ok(Math.abs(value - shown.said[3 * leg + i]) < 1e-4, `foot ${leg}`)),
    );
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test("paths of the feet are where the robot has them, at equal scales", async () => {
  const { page, problems } = await open("walk.html");
  const shown = await page.evaluate(() => {
    const { feet, player, report, runs, view } = window.crossgait;
    player.playing = false;
    const { legs } = report.motions[0].scene;
    return [0, 100, 250].map((frame) => {
      player.seek(runs[0].time[frame] + 1e-6);
      const robot = view.robots[0];
      return legs.map((leg, i) => {
        // The foot as three.js has it, in the base's own frame.
        const local = robot.bodies[0].worldToLocal(robot.feet[i].getWorldPosition(robot.feet[i].position.clone()));
        return {
          drawn: feet[i].points[0][frame],
          robot: [1e3 * (local.x - leg.origin[0]), 1e3 * (local.z - leg.origin[2])],
        };
      });
    });
  });
  // mm; as above, 1e-4 m is what nobody sees.
  for (const { drawn, robot } of shown.flat())
    drawn.forEach((value, i) => assert.ok(Math.abs(value - robot[i]) < 0.1, `${drawn} at ${robot}`));
  await page.evaluate(() => window.crossgait.feet.at(-1).element.scrollIntoView());
  await page.waitForFunction(() => window.crossgait.feet.every((f) => f.pixelsPerUnit));
  await expectEqualScales(page, "feet", 4);
  assert.equal(
    await page.locator("details tbody tr").count(),
    await page.evaluate(() => window.crossgait.report.motions[0].constants.length),
  );
  assert.deepEqual(problems, []);
  await page.close();
});

/** A unit is as long along y as along x; and contents are drawn in colours, not on an empty frame. */
async function expectEqualScales(page, name, count) {
  const units = await page.evaluate(
    (of) => window.crossgait[of].filter((c) => c.chart.equal_scales).map((c) => c.pixelsPerUnit),
    name,
  );
  assert.equal(units.length, count);
  for (const [x, y] of units)
    assert.ok(x > 0 && Math.abs(y / x - 1) < 0.01, `a unit is ${x} px along x and ${y} px along y`); // whole pixels
}

/** How many colours a chart's picture has. */
function coloursOf(page, index) {
  return page.evaluate((i) => {
    const canvas = window.crossgait.charts[i].element.querySelector("canvas:not(.shades)");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  }, index);
}

test("a workspace shows what its result says, shaded, at equal scales", async () => {
  const { page, problems } = await open("workspace.html");
  const result = JSON.parse(readFileSync(join(pages, "workspace.json"), "utf8"));
  await page.waitForFunction(() => window.crossgait.charts.every((c) => c.pixelsPerUnit));
  await expectEqualScales(page, "charts", 2);
  for (const [i, axis] of [0, 1].entries()) {
    const foot = await page.evaluate((at) => window.crossgait.charts[at].points[1][0], i);
    assert.deepEqual(foot, [1e3 * result.standing_foot_m[axis], 1e3 * result.standing_foot_m[2]]);
    const colours = await coloursOf(page, i);
    assert.ok(colours > 200, `shades of ${colours} colours`);
  }
  for (const words of [
    "safe box",
    "path, trot",
    "standing foot",
    "smallest margin, deg",
    "z up from the shoulders, mm",
  ])
    assert.ok((await page.textContent(".results")).includes(words), words);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a gait shows its steps, paths and targets", async () => {
  const { page, problems } = await open("gait.html");
  const { samples } = JSON.parse(readFileSync(join(pages, "gait.json"), "utf8"));
  await page.evaluate(() => document.querySelectorAll(".panel").forEach((panel) => panel.scrollIntoView()));
  await page.waitForFunction(() => window.crossgait.charts.every((c) => c.pixelsPerUnit));
  assert.equal(await page.locator(".panel").count(), 8);
  await expectEqualScales(page, "charts", 4);
  const path = await page.evaluate(() => window.crossgait.charts[1].points[0]);
  assert.deepEqual(
    path,
    samples.map(({ FL }) => [1e3 * FL.position_m[0], 1e3 * FL.position_m[2]]),
  );
  assert.deepEqual(problems, []);
  await page.close();
});

test("it plays, and cursor and robot move together", async () => {
  const { page, problems } = await open("compare.html");
  const begin = await time(page);
  await page.keyboard.press(" ");
  // Pictures take their time without a graphics card.
  await page.waitForFunction((t) => window.crossgait.player.time > t + 0.1, begin);
  await page.keyboard.press(" ");
  const now = await time(page);
  assert.ok(now > begin + 0.1, `played from ${begin} to ${now} s`);
  await page.waitForTimeout(100);
  assert.equal(await time(page), now, "paused");
  await expectCursorsAt(page, now);
  await page.keyboard.press("ArrowRight");
  const step = (await time(page)) - now;
  assert.ok(step > 0 && step <= 0.0151, `a frame on: ${step} s`);
  await page.keyboard.press("Home");
  assert.equal(await time(page), begin);
  await page.keyboard.press("p");
  const parted = await page.evaluate(
    () => window.crossgait.report.motions[0].pairs.find((p) => p.a === 0 && p.parting.time_s).parting.time_s,
  );
  assert.equal(await time(page), parted, "where the engines part");
  assert.ok(parted > begin + 0.5, `a soft contact that stands deeper is no parting: ${parted} s`);
  const plot = page.locator(".plot .u-over").nth(1);
  const box = await plot.boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const middle = await time(page);
  assert.ok(middle > 2.5 && middle < 3.5, `the middle of the plot is ${middle} s`);
  await expectCursorsAt(page, middle);
  await page.keyboard.press("End");
  const x = await page.evaluate(() => window.crossgait.view.robots.map((r) => r.bodies[0].position.x));
  for (const at of x) assert.ok(at > 1, `walked ${at} m`);
  assert.deepEqual(problems, []);
  await page.close();
});

test("keys alone reach everything, and turn and part the view", async () => {
  const { page, problems } = await open("compare.html");
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    reached.add(
      await page.evaluate(
        () => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent,
      ),
    );
  }
  for (const name of ["Play or pause (space)", "Time, s", "Speed", "Light or dark (t)", "FR"])
    assert.ok(reached.has(name), `${name} among ${[...reached]}`);
  const unnamed = await page.evaluate(
    () =>
      [...document.querySelectorAll("button, input, select, canvas[tabindex]")].filter(
        (e) => !(e.getAttribute("aria-label") || e.textContent || e.closest("label")?.textContent),
      ).length,
  );
  assert.equal(unnamed, 0, "every control has a name");
  const place = () => page.evaluate(() => window.crossgait.view.viewpoint.camera.position.toArray());
  const first = await place();
  await page.keyboard.press("d");
  assert.notDeepEqual(await place(), first);
  const ys = () => page.evaluate(() => window.crossgait.view.robots.map((r) => r.parent.position.y));
  assert.deepEqual(await ys(), [0, 0, 0]);
  await page.keyboard.press("b");
  const apart = await ys();
  assert.ok(apart[0] > apart[2], `side by side: ${apart}`);
  const seen = await page.evaluate(() => window.crossgait.view.robots.map((r) => r.parent.visible));
  assert.deepEqual(seen, [true, false, true], "engines that do the same are drawn once");
  assert.deepEqual(problems, []);
  await page.close();
});

test("light and dark, by the system and by hand; and a phone", async () => {
  for (const scheme of ["light", "dark"]) {
    const { page, problems } = await open("compare.html", { scheme });
    const colours = () =>
      page.evaluate(() => [
        getComputedStyle(document.body).backgroundColor,
        window.crossgait.view.three.background.getHexString(),
      ]);
    const before_ = await colours();
    const brightness = Number(before_[0].match(/\d+/)[0]);
    assert.ok(scheme === "light" ? brightness > 200 : brightness < 60, before_[0]);
    await page.keyboard.press("t");
    const after_ = await colours();
    assert.notEqual(after_[0], before_[0]);
    assert.notEqual(after_[1], before_[1]);
    assert.deepEqual(problems, []);
    await page.close();
  }
  const { page, problems } = await open("compare.html", { width: 390, height: 844 });
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, "nothing sticks out");
  assert.deepEqual(problems, []);
  await page.close();
});

/** Where in the picture the bases are that are drawn, from -1 to 1. */
const placesInPicture = (page) =>
  page.evaluate(() => {
    const { view } = window.crossgait;
    view.drawNow();
    view.viewpoint.camera.updateMatrixWorld();
    return view.robots
      .filter((robot) => robot.parent.visible)
      .map((robot) => {
        const at = robot.bodies[0].getWorldPosition(robot.position.clone()).project(view.viewpoint.camera);
        return [at.x, at.y];
      });
  });

test("every robot stays in the picture, up a slope and down it, with its name", async () => {
  const { page, problems } = await open("slope.html");
  for (const layout of ["in one place", "side by side"]) {
    if (layout === "side by side") await page.keyboard.press("b");
    for (const preset of ["1", "2", "3", "4"]) {
      await page.keyboard.press(preset);
      await page.keyboard.press("Home");
      for (const at of [1.5, 3, 4.5, 6]) {
        await page.evaluate((t) => window.crossgait.player.seek(t), at);
        const places = await placesInPicture(page);
        assert.equal(places.length, 2);
        for (const [x, y] of places)
          assert.ok(Math.abs(x) < 0.95 && Math.abs(y) < 0.95, `${layout}, view ${preset}, ${at} s: ${places}`);
        assert.equal(await page.evaluate(() => window.crossgait.view.outside), 0);
      }
    }
  }
  await page.keyboard.press("End");
  await placesInPicture(page);
  const names = await page.locator(".tag:not([hidden]) b").allTextContents();
  assert.equal(names.length, 2);
  assert.match(names[0], /^mujoco = bullet:matched: walked/);
  assert.match(names[1], /^bullet: slid 1\.5\d m back$/);
  // Who is out of sight is pointed at from the edge.
  await page.getByLabel("follow").uncheck();
  await page.evaluate(() => {
    const { view } = window.crossgait;
    view.viewpoint.camera.position.y -= 100;
    view.viewpoint.controls.target.y -= 100;
    view.viewpoint.camera.lookAt(view.viewpoint.controls.target);
    view.viewpoint.camera.updateMatrixWorld();
    view.drawNow();
  });
  assert.equal(await page.locator(".tag.out").count(), 2);
  assert.deepEqual(problems, []);
  await page.close();
});

test("the answer is on top, in the words of the result", async () => {
  const { page, problems } = await open("slope.html");
  const answer = page.locator("header .answer");
  const report = await page.evaluate(() => window.crossgait.report);
  assert.match(report.summary, /walked 1\.02 m in mujoco and bullet:matched, but slid 1\.53 m back in bullet/);
  assert.equal(await answer.locator("p").textContent(), typeset(report.summary));
  assert.deepEqual(await answer.locator("li").allTextContents(), report.groups.map(typeset));
  assert.ok((await answer.boundingBox()).y < 200, "above the fold");
  // All controls of the replay are in sight, too.
  const transport = await page.locator(".transport").boundingBox();
  assert.ok(transport.y + transport.height <= 900, `${transport.y} px`);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a fall is a mark on the time line, and in the name", async () => {
  const { page, problems } = await open("fall.html");
  const runs = JSON.parse(readFileSync(join(pages, "fall.json"), "utf8")).runs;
  const fallen = runs.filter((run) => run.outcome === "fell");
  assert.ok(fallen.length > 0, "somebody falls");
  const { fell_at_s: at, engine } = fallen[0];
  const place = runs.indexOf(fallen[0]);
  const marked = await page.evaluate((i) => window.crossgait.report.motions[0].runs[i].outcome_at_s, place);
  assert.ok(Math.abs(marked - (await time(page)) - at) < 0.01, `${marked} s`); // a control step, a frame
  const mark = page.locator(`.marks i[title^="${engine} fell"]`);
  assert.equal(await mark.count(), 1);
  await page.getByRole("button", { name: `${engine} fell` }).click();
  assert.equal(await time(page), marked);
  await placesInPicture(page);
  assert.match((await page.locator(".tag b").allTextContents()).join(), new RegExp(`${engine}: fell at`));
  assert.deepEqual(problems, []);
  await page.close();
});

test("a link leads to the same moment, view and engines", async () => {
  const { page, problems } = await open("compare.html");
  await page.evaluate(() => window.crossgait.player.seek(window.crossgait.player.begin + 2.3));
  await page.keyboard.press("2");
  await page.getByRole("checkbox", { name: "bullet", exact: true }).uncheck();
  await page.waitForFunction(() => location.hash.includes("engines="));
  const hash = await page.evaluate(() => location.hash);
  assert.equal(hash, "#t=2.3&view=side&engines=mujoco,bullet%3Amatched");
  const camera = await page.evaluate(() => window.crossgait.view.viewpoint.camera.position.toArray());
  await page.close();
  const again = await browser.open(`file://${join(pages, "compare.html")}${hash}`);
  assert.ok(Math.abs((await time(again.page)) - 2.8) < 0.01, "0.5 s of standing, and 2.3");
  assert.deepEqual(await again.page.evaluate(() => window.crossgait.view.shown), [true, true, false]);
  const there = await again.page.evaluate(() => window.crossgait.view.viewpoint.camera.position.toArray());
  // A picture of the same shape, whose height may be a line of words more.
  there.forEach((at, i) => assert.ok(Math.abs(at - camera[i]) < 0.02, `${there}, before ${camera}`));
  // By hand, too.
  await again.page.keyboard.press("d");
  await again.page.waitForFunction(() => /view=-?\d+,-?\d+,[\d.]+/.test(location.hash));
  await again.page.evaluate(() => (location.hash = "#t=1&view=top"));
  await again.page.waitForFunction(() => window.crossgait.view.viewpoint.preset === "top");
  assert.deepEqual([...problems, ...again.problems], []);
  await again.page.close();
});

test("without WebGL there is everything but the picture", async () => {
  const { page, problems } = await open("compare.html", {
    before: withoutPicture,
  });
  assert.equal(await page.evaluate(() => window.crossgait.view), null);
  assert.match(await page.locator(".canvas").textContent(), /no WebGL/);
  await page.evaluate(() => window.crossgait.player.seek(2));
  await page.waitForFunction(() => window.crossgait.plots.all.some((p) => p.visible));
  await expectCursorsAt(page, 2);
  await page.keyboard.press("p");
  assert.ok((await page.textContent(".results")).includes("cost of transport"), "the statistics");
  // three.js says itself that there is no context.
  assert.deepEqual(
    problems.filter((words) => !words.includes("WebGL")),
    [],
  );
  await page.close();
});

test("rounding is drawn as a line, and engines by their own colours and dashes", async () => {
  const { page, problems } = await open("slope.html");
  await page.evaluate(() => window.crossgait.plots.all.forEach((plot) => plot.ensure()));
  await page.waitForTimeout(200);
  const floors = { deg: 0.1, "m/s": 1e-3, "deg/s": 1 };
  const shown = await page.evaluate(() =>
    window.crossgait.plots.all
      .filter((p) => p.panel && !p.panel.log && p.plot)
      .map((p) => ({ unit: p.panel.unit, range: [p.plot.scales.y.min, p.plot.scales.y.max] })),
  );
  assert.ok(shown.length > 5);
  for (const { unit, range } of shown)
    if (floors[unit]) assert.ok(range[1] - range[0] >= 0.999 * floors[unit], `${unit}: ${range}`);
  const keys = await page.evaluate(() =>
    window.crossgait.plots.all[0].keys.map((k) => [k.title, k.colour(), Boolean(k.dash)]),
  );
  assert.deepEqual(keys.slice(0, 3), [
    ["mujoco", "#0072b2", false],
    ["bullet:matched", "#d55e00", true],
    ["bullet", "#d55e00", false],
  ]);
  // Of differences those from the first engine, of engines that are no other's like.
  const differences = await page.evaluate(() =>
    window.crossgait.plots.all.filter((p) => p.panel?.group === "differences").map((p) => p.panel.series.length),
  );
  assert.deepEqual(differences, [1, 1, 1]);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a figure is saved as SVG and PNG", async () => {
  const { page, problems } = await open("slope.html");
  await page.evaluate(() => window.crossgait.plots.all.slice(0, 2).forEach((plot) => plot.ensure()));
  await page.waitForTimeout(200);
  for (const [index, element, least] of [
    [0, "rect", 50],
    [1, "polyline", 3],
  ]) {
    const found = await page.evaluate(
      ([i, name]) => {
        const svg = new DOMParser().parseFromString(window.crossgait.plots.all[i].svg(), "image/svg+xml");
        const points = [...svg.querySelectorAll("g polyline")].map((line) => line.getAttribute("points"));
        return {
          broken: svg.querySelector("parsererror")?.textContent ?? null,
          count: svg.querySelectorAll(`g ${name}`).length,
          words: [...svg.querySelectorAll("text")].map((t) => t.textContent),
          finite: points.every((p) => p.split(/[ ,]/).every((n) => Number.isFinite(Number(n)))),
        };
      },
      [index, element],
    );
    assert.equal(found.broken, null);
    assert.ok(found.count >= least, `${found.count} of ${element}`);
    assert.ok(found.finite);
    assert.ok(found.words.some((w) => w.includes("bullet")) && found.words.some((w) => w.endsWith(" s")), found.words);
  }
  for (const how of ["png", "svg"]) {
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.locator(".panel").first().getByRole("button", { name: how }).click(),
    ]);
    assert.ok(download.suggestedFilename().endsWith(`.${how}`));
    const bytes = readFileSync(await download.path());
    assert.ok(bytes.length > 2000 && (how === "svg" || bytes.subarray(1, 4).toString() === "PNG"));
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test("pairs of a verdict are folded, and opened from the table", async () => {
  const { page, problems } = await open("many.html");
  const folded = page.locator("section.verdict details");
  assert.equal(await folded.count(), 3);
  assert.equal(await page.locator("section.verdict details[open]").count(), 0);
  await page.locator("button.word").first().click();
  const open_ = page.locator("section.verdict details[open]");
  assert.equal(await open_.count(), 1);
  assert.match(await open_.locator("h2").textContent(), /mujoco and bullet|bullet and mujoco/);
  assert.deepEqual(problems, []);
  await page.close();
});

test("text out of files is shown, never run", async () => {
  const { page, problems } = await open("hostile.html");
  assert.equal(await page.evaluate(() => window.hostile), undefined);
  assert.ok((await page.textContent("header")).includes("</script><script>window.hostile = 1</script>"));
  assert.deepEqual(problems, []);
  await page.close();
});

test("a benchmark shows its curves", async () => {
  const { page, problems } = await open("bench.html");
  await page.evaluate(() => document.querySelectorAll(".panel").forEach((panel) => panel.scrollIntoView()));
  await page.waitForTimeout(300);
  const [figures, drawn, points] = await page.evaluate(() => {
    const { charts } = window.crossgait;
    return [
      charts.length,
      document.querySelectorAll(".panel canvas").length,
      charts.reduce((sum, c) => sum + c.points.flat().length, 0),
    ];
  });
  assert.ok(figures >= 10 && drawn === figures, `${drawn} of ${figures} charts`);
  assert.ok(points > 100, `${points} points`);
  assert.ok((await page.textContent("pre.text")).includes("us"), "the tables as they are printed");
  assert.deepEqual(problems, []);
  await page.close();
});

test("what engines make of a robot is shown in it, and taken away again", async () => {
  const { page, problems } = await open("walk.html");
  const look = () =>
    page.evaluate(() => {
      const [robot] = window.crossgait.view.robots;
      const count = (name) =>
        robot.bodies.flatMap((body) => body.children).filter((part) => part.name === name && part.visible).length;
      const collision = robot.parts.scene.bodies.map(({ collision }) => collision.length);
      const drawn = robot.bodies.map(
        (body) => body.children.find((part) => part.name === "collision")?.children.length,
      );
      return { collision, drawn, shown: ["collision", "inertia", "frames"].map(count), bodies: robot.bodies.length };
    });
  assert.deepEqual((await look()).shown, [0, 0, 0]);
  for (const name of ["collision", "inertia", "frames"]) await page.getByLabel(name, { exact: false }).first().check();
  const all = await look();
  assert.deepEqual(all.shown, [all.bodies, all.bodies, all.bodies]);
  assert.deepEqual(all.drawn, all.collision);
  assert.ok(all.collision.some((shapes) => shapes > 0));
  await page.getByLabel("inertia").uncheck();
  assert.deepEqual((await look()).shown, [all.bodies, 0, all.bodies]);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a picture that comes too slowly is coarser while it moves, and whole when it stands", async () => {
  const { page, problems } = await open("walk.html");
  const levels = await page.evaluate(() => {
    const { detail } = window.crossgait.view;
    const at = (now) => detail.next(now);
    const quick = Array.from({ length: 40 }, (_, i) => at(1e6 + 40 * i)).at(-1);
    const slow = Array.from({ length: 40 }, (_, i) => at(2e6 + 100 * i));
    const later = at(3e6);
    const again = at(3e6 + 40);
    return { quick, slow, later, again };
  });
  const whole = { pixels: 1, coarse: false, shadow: 1 };
  assert.deepEqual(levels.quick, whole, "where it keeps up nothing is left out");
  assert.deepEqual(levels.slow[0], whole);
  const pixels = levels.slow.map((level) => level.pixels);
  assert.deepEqual(
    pixels,
    [...pixels].sort((a, b) => b - a),
    "coarser step by step",
  );
  assert.deepEqual(levels.slow.at(-1), { pixels: 1 / 4, coarse: true, shadow: 4 });
  assert.deepEqual(levels.later, whole, "what begins to move");
  assert.deepEqual(levels.again, levels.slow.at(-1), "goes on as coarse as it had to be");

  const sizes = await page.evaluate(async () => {
    const { view } = window.crossgait;
    const size = () => [view.canvas.width, view.canvas.height];
    view.drawNow();
    const before = size();
    view.drawNow({ pixels: 0.5, coarse: true, shadow: 4 });
    const moving = size();
    view.detail.next(performance.now());
    view.detail.next(performance.now());
    await new Promise((resolve) => setTimeout(resolve, 1000));
    return { before, moving, after: size() };
  });
  assert.deepEqual(sizes.after, sizes.before);
  sizes.moving.forEach((size, i) => assert.ok(Math.abs(2 * size - sizes.before[i]) <= 2, `${JSON.stringify(sizes)}`));

  const meshes = await page.evaluate(() => {
    const [{ parts, meshes }] = window.crossgait.view.robots;
    const Box = meshes.map(({ mesh }) => mesh.geometry).find((geometry) => geometry.type === "BoxGeometry").constructor;
    const part = { shape: { type: "mesh" }, geometry: new Box(0.02, 0.04, 0.06, 40, 40, 40) };
    const coarse = parts.coarseOf(part);
    coarse.computeBoundingBox();
    const { min, max } = coarse.boundingBox;
    return {
      fine: part.geometry.index.count / 3,
      coarse: coarse.index.count / 3,
      off: [max.x - 0.01, max.y - 0.02, max.z - 0.03, -min.x - 0.01, -min.y - 0.02, -min.z - 0.03].map(Math.abs),
      again: parts.coarseOf(part) === coarse,
      cell: 0.05 * (parts.scene.standing_height || 0.2),
    };
  });
  assert.equal(meshes.fine, 19200);
  assert.ok(meshes.coarse > 12 && meshes.coarse < meshes.fine / 10, `${meshes.coarse} triangles`);
  assert.ok(Math.max(...meshes.off) <= meshes.cell, "as large as it was");
  assert.ok(meshes.again, "made once");
  assert.deepEqual(problems, []);
  await page.close();
});

test("a rollout shows what it earned, and what its feet span", async () => {
  const { page, problems } = await open("rollout.html");
  assert.ok((await page.textContent(".results")).includes("What a policy step earns"));
  await page.getByLabel("support").check();
  const shown = await page.evaluate(() => {
    const { player, view, runs } = window.crossgait;
    player.playing = false;
    player.seek(player.begin + 0.5);
    const { support } = view.robots[0];
    const frame = runs[0].frameAt(player.time);
    const loaded = [0, 1, 2, 3].filter(
      (leg) => Math.hypot(...runs[0].forces.subarray(12 * frame + 3 * leg, 12 * frame + 3 * leg + 3)) > 0,
    );
    return {
      visible: support.visible,
      corners: support.corners.length,
      loaded: loaded.length,
      com: support.centreOfMass.toArray(),
      base: view.robots[0].bodies[0].position.toArray(),
    };
  });
  assert.ok(shown.visible);
  assert.ok(
    shown.loaded > 0 && shown.corners <= shown.loaded && shown.corners >= Math.min(3, shown.loaded),
    JSON.stringify(shown),
  );
  shown.com.forEach((at, i) =>
    assert.ok(Math.abs(at - shown.base[i]) < 0.05, `the centre of mass is in the robot: ${JSON.stringify(shown)}`),
  );
  assert.deepEqual(problems, []);
  await page.close();
});

test("a verdict begins with its sentence and shows every gap against its margin", async () => {
  const { page, problems } = await open("verdict.html");
  const result = JSON.parse(readFileSync(join(pages, "verdict.json"), "utf8"));
  const statistics = result.pairs[0].statistics;
  assert.match(result.summary, /statistics|differ|resolved/);
  assert.equal(await page.locator("header .answer p").textContent(), typeset(result.summary));
  assert.equal(await page.locator("svg .dot").count(), statistics.length);
  for (const [i, { gap, margin, word }] of statistics.entries()) {
    const row = page.locator(".verdict tbody tr").nth(i);
    assert.equal(await row.locator(".word").textContent(), word);
    const [x, from, width] = await row.evaluate((r) => [
      r.querySelector(".dot").cx.baseVal.value,
      r.querySelector(".within").x.baseVal.value,
      r.querySelector(".within").width.baseVal.value,
    ]);
    assert.equal(x >= from && x <= from + width, Math.abs(gap) <= margin, `${word} ${gap}`);
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test("a verdict of many begins with who agrees", async () => {
  const { page, problems } = await open("many.html");
  const result = JSON.parse(readFileSync(join(pages, "many.json"), "utf8"));
  assert.deepEqual(
    await page
      .locator(".results h2")
      .allTextContents()
      .then((heads) => heads.map((head) => head.replace(/ (agrees|differs|step-dependent|unresolved)$/, ""))),
    ["Which engines agree", ...result.pairs.map(({ engines }) => engines.join(" and ")), "Where this comes from"],
  );
  assert.deepEqual(
    await page.locator("header .answer li").allTextContents(),
    result.groups.length > 1 ? result.groups.map(({ sentence }) => typeset(sentence)) : [],
  );
  const matrix = page.locator(".results section").first();
  assert.equal(await matrix.locator("td .word").count(), 2 * result.pairs.length, "every pair, either way round");
  assert.match(await matrix.textContent(), /[Oo]utlier|agree/);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a diagnosis ranks changes by their effect, and replays every command beside the cure", async () => {
  const result = JSON.parse(readFileSync(join(pages, "diagnosis.json"), "utf8"));
  const { page, problems } = await open("diagnosis.html");
  assert.equal(await page.locator("header .answer p").textContent(), typeset(result.summary));
  const [ranking, walks, tests] = [0, 1, 2].map((i) => page.locator(".answers section").nth(i).locator("tbody"));
  assert.equal(await ranking.locator(".dot").count(), result.ranking.length);
  for (const [i, { field, cures, low, high }] of result.ranking.entries()) {
    const row = ranking.locator("tr").nth(i);
    assert.equal(await row.locator("th").textContent(), field);
    assert.equal(await row.locator("td.good").count(), cures ? 1 : 0);
    const [x1, x2, zero] = await row.evaluate((r) => [
      r.querySelector(".interval").x1.baseVal.value,
      r.querySelector(".interval").x2.baseVal.value,
      r.querySelector(".zero").x1.baseVal.value,
    ]);
    assert.equal(x1 > zero, low > 0, `from ${low}`);
    assert.equal(x2 > zero, high > 0, `to ${high}`);
  }
  assert.equal(await walks.locator("tr").count(), 2 * result.walks.length);
  assert.equal(await tests.locator("tr").count(), result.tests.length);
  assert.ok((await tests.textContent()).includes(typeset(result.tests[0].limits)));
  const apart = () => page.evaluate(() => window.crossgait.view.robots.map((robot) => robot.parent.position.y));
  for (const { command } of result.walks) {
    await page.getByRole("button", { name: command, exact: true }).click();
    assert.deepEqual(await page.evaluate(() => window.crossgait.runs.map((run) => run.name)), [
      "as given",
      "with the change",
    ]);
    assert.equal(await page.locator(".stage").count(), 1);
    const [given, changed] = await apart();
    assert.ok(given > changed, `side by side: ${given} and ${changed} m`);
    assert.ok(
      await page.evaluate(() => window.crossgait.plots.all.some((plot) => plot.panel?.group === "differences")),
      `gaps of ${command}`,
    );
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test("a course says what became of the runs by section and engine, and replays the first of each", async () => {
  const result = JSON.parse(readFileSync(join(pages, "course.json"), "utf8"));
  const { page } = await open("course.html", { before: withoutPicture });
  assert.equal(await page.locator("header .answer p").textContent(), typeset(result.summary));
  assert.deepEqual(
    await page.locator("header .answer li").allTextContents(),
    result.groups.map(({ sentence }) => typeset(sentence)),
  );
  const outcomes = page.locator(".answers section").first();
  const engines = result.scores.map(({ engine }) => engine);
  assert.deepEqual(await outcomes.locator("thead th").allTextContents(), ["section", ...engines]);
  for (const { section, engine, all } of result.cells) {
    const row = outcomes.locator("tbody tr", { has: page.getByRole("rowheader", { name: section.name }) });
    const cell = row.locator("td").nth(engines.indexOf(engine));
    const walked = all.outcomes.walked ?? 0;
    const mark = walked === all.episodes ? "good" : walked > 0 ? "mixed" : "bad";
    assert.match(await cell.getAttribute("class"), new RegExp(`\\b${mark}\\b`), `${section.name} in ${engine}`);
  }
  const sections = [...new Set(result.cells.map(({ section }) => section.name))];
  const replays = page.locator(".replays");
  assert.deepEqual(await replays.locator("button").allTextContents(), sections);
  await replays.locator("button").last().click();
  const shown = await page.evaluate(() => window.crossgait.runs.map((run) => run.name));
  assert.deepEqual(shown, engines);
  await page.close();
});

test("a link leads to a replay of several", async () => {
  const { page, problems } = await open("diagnosis.html#replay=standing&t=0.1");
  assert.equal(await page.locator(".replays [aria-pressed=true]").textContent(), "standing");
  const since = await page.evaluate(() => window.crossgait.player.since(window.crossgait.player.time));
  assert.ok(Math.abs(since - 0.1) < 1e-6, `${since} s`);
  assert.deepEqual(problems, []);
  await page.close();
});

// A4 without its margins, in the pixels of a style sheet.
test("nothing is wider than paper", async () => {
  for (const name of [
    "many.html",
    "verdict.html",
    "compare.html",
    "diagnosis.html",
    "course.html",
    "bench.html",
    "workspace.html",
    "gait.html",
  ]) {
    const before_ = name === "compare.html" ? null : withoutPicture;
    const { page } = await open(name, { width: 703, height: 1000, before: before_ });
    await page.emulateMedia({ media: "print" });
    const wide = await page.evaluate(() =>
      [...document.querySelectorAll(".scroll, .panel, .stage")]
        .filter((box) => box.scrollWidth > box.clientWidth + 1)
        .map((box) => `${box.textContent.slice(0, 40)}: ${box.scrollWidth} of ${box.clientWidth}`),
    );
    assert.deepEqual(wide, [], name);
    await page.close();
  }
});
