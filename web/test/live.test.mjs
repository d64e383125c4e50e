// The live page in a real browser, at the server of $CROSSGAIT view. Pictures take their time without a graphics card: the
// tests wait for what is to happen, and have a limit for what never does.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { networkInterfaces, tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { violations } from "./axe.mjs";
import { Browser } from "./browser.mjs";

// A page that did not read for seconds is let go by the server, and asks again: so it goes without a graphics card.
const browser = new Browser(/^(file:|http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\/|data:|blob:)/, [
  "ERR_INCOMPLETE_CHUNKED_ENCODING",
]);
let server;
let address;
let engines;

before(async () => {
  await browser.launch();
  server = spawn(process.env.CROSSGAIT, ["view"], { stdio: ["ignore", "pipe", "inherit"] });
  address = await new Promise((resolve, reject) => {
    server.stdout.once("data", (text) => resolve(String(text).split("\n")[0]));
    server.once("exit", (code) => reject(new Error(`crossgait view ended with ${code}`)));
  });
  engines = (await (await fetch(`${address}options`)).json()).engines;
});
after(async () => {
  const ended = new Promise((resolve) => server.once("exit", resolve));
  server.kill("SIGINT");
  assert.equal(await ended, 0, "Ctrl-C is how it ends");
  await browser.close();
});

const frame = (page) => page.evaluate(() => window.crossgait.frame);
async function openLive(options) {
  const opened = await browser.open(address, options);
  await opened.page.waitForFunction(() => window.crossgait.view && window.crossgait.frame);
  return opened;
}
/** Of the robot in the picture, m. */
const shownBase = (page, robot = 0) =>
  page.evaluate((i) => window.crossgait.view.robots[i].bodies[0].position.toArray(), robot);
/** Of the robot's base on the screen, px. */
const placeOfBase = (page) =>
  page.evaluate(() => {
    const { view } = window.crossgait;
    view.viewpoint.camera.updateMatrixWorld();
    const at = view.robots[0].bodies[0]
      .getWorldPosition(view.viewpoint.camera.position.clone())
      .project(view.viewpoint.camera);
    const box = view.canvas.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  });
const command = (body) =>
  fetch(`${address}command`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });

test("it keeps the rules of WCAG, light and dark", async () => {
  const { page } = await openLive();
  assert.deepEqual(await violations(page), []);
  await page.keyboard.press("t");
  assert.deepEqual(await violations(page, ["color-contrast"]), [], "dark");
  await page.close();
});

test("it shows the robot, and keys drive it", async () => {
  const { page, problems } = await openLive();
  assert.match(page.url(), /^http:\/\/127\.0\.0\.1:/);
  assert.equal(await page.evaluate(() => window.crossgait.view.robots.length), 1);
  const [x] = await shownBase(page);
  for (let i = 0; i < 3; ++i) await page.keyboard.press("ArrowUp");
  await page.waitForFunction(() => window.crossgait.frame.command.vx > 0.1);
  await page.waitForFunction((from) => window.crossgait.view.robots[0].bodies[0].position.x > from + 0.1, x);
  const at = await page.evaluate(() => [
    window.crossgait.view.robots[0].bodies[0].position.toArray(),
    window.crossgait.runs[0].poses.slice(-7 * window.crossgait.view.robots[0].bodies.length).slice(0, 3),
  ]);
  at[0].forEach((value, i) => assert.ok(Math.abs(value - at[1][i]) < 1e-4, "the picture is where the frame has it"));
  await page.keyboard.press(" ");
  await page.waitForFunction(() => window.crossgait.frame.command.vx === 0);
  assert.deepEqual(problems, []);
  await page.close();
});

test("another engine goes on where this one was", async () => {
  const { page, problems } = await openLive();
  await page.keyboard.press("ArrowUp");
  for (const engine of [...engines.slice(1), engines[0]]) {
    const before_ = await frame(page);
    await page.getByLabel("Engine", { exact: true }).selectOption(engine);
    await page.waitForFunction((name) => window.crossgait.frame.robots[0].engine === name, engine);
    const after_ = await frame(page);
    assert.ok(after_.robots[0].time > before_.robots[0].time, "time goes on");
    // 60 mm/s for as long as a machine may take: the robot is not put back to where it began.
    const way = Math.hypot(
      after_.robots[0].poses[0] - before_.robots[0].poses[0],
      after_.robots[0].poses[1] - before_.robots[0].poses[1],
    );
    const most = 0.02 + 0.3 * (after_.robots[0].time - before_.robots[0].time);
    assert.ok(way < most, `${way} m in ${after_.robots[0].time - before_.robots[0].time} s`);
  }
  await page.keyboard.press(" ");
  assert.deepEqual(problems, []);
  await page.close();
});

/** Drops files on the page, as a hand does that holds no folders. */
const drop = (page, files) =>
  page.evaluate((named) => {
    const transfer = new DataTransfer();
    for (const [name, text] of named) transfer.items.add(new File([text], name));
    dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, cancelable: true }));
  }, files);

test("another robot and a policy are chosen, and a file is dropped", async () => {
  const { page, problems } = await openLive();
  const at_first = await page.getByLabel("Robot", { exact: true }).inputValue();
  const ground = await page.evaluate(() => window.crossgait.frame.terrain);
  await page.getByLabel("trails").uncheck();
  await page.getByLabel("Policy").selectOption("serial_joints");
  await page.waitForFunction(() => window.crossgait.options.policy === "serial_joints");
  await page.waitForFunction(() => window.crossgait.view.robots.length === 1 && window.crossgait.frame.gait === null);
  assert.equal(await page.getByLabel("Robot", { exact: true }).inputValue(), "serial_quadruped");
  assert.ok(await page.getByLabel("Gait", { exact: true }).isDisabled(), "a policy of joints has none");
  assert.equal(await page.evaluate(() => window.crossgait.view.trails), false, "switches stay as they are");
  for (let i = 0; i < 5; ++i) await page.keyboard.press("ArrowUp");
  await page.waitForFunction(() => window.crossgait.view.robots[0].bodies[0].position.x > 0.1);

  await drop(page, [["notes.txt", "no robot"]]);
  await page.waitForFunction(() => document.querySelector(".trouble").textContent.includes("dropped files: robot"));
  const robots = join(process.env.CROSSGAIT_ROBOTS, "scara_quadruped_long");
  const files = ["robot.yaml", "robot.urdf"].map((name) => [name, readFileSync(join(robots, name), "utf8")]);
  await drop(page, files);
  await page.waitForFunction(() => window.crossgait.options.robot.endsWith("/robot.yaml"));
  await page.waitForFunction(() => document.querySelector(".trouble").textContent === "");
  assert.equal(await page.getByLabel("Policy").inputValue(), "");
  assert.equal(await page.evaluate(() => window.crossgait.frame.terrain), ground);

  const other = await openLive();
  await other.page.getByLabel("Robot", { exact: true }).selectOption(at_first);
  for (const each of [page, other.page])
    await each.waitForFunction((name) => window.crossgait.options.robot === name, at_first);
  assert.deepEqual([...problems.filter((problem) => !problem.includes("400")), ...other.problems], []);
  await other.page.close();
  await page.close();
});

test("two engines walk side by side, on another ground, and two look on", async () => {
  const { page, problems } = await openLive();
  const other = await openLive({ scheme: "dark" });
  await page.getByLabel("Engine beside it, 1").selectOption(engines[engines.length - 1]);
  for (const each of [page, other.page]) await each.waitForFunction(() => window.crossgait.view.robots.length === 2);
  await page.keyboard.press("b");
  const ys = await page.evaluate(() => window.crossgait.view.robots.map((robot) => robot.parent.position.y));
  assert.ok(ys[0] > ys[1], `side by side: ${ys}`);
  await page.getByLabel("collision").check();
  // On ground that is not alike everywhere each takes a strip of it along.
  await page.getByLabel("Ground", { exact: true }).selectOption("rough");
  const onRough = (strips) =>
    window.crossgait.frame.terrain === "rough" &&
    window.crossgait.view.motion.scene.ground &&
    window.crossgait.view.strips.length === strips;
  await page.waitForFunction(onRough, 2);
  await other.page.waitForFunction(onRough, 0); // which has them in one place
  // What is chosen to be seen stays so in a view that is made anew.
  const seen = (at) => at.evaluate(() => [...window.crossgait.view.insides]);
  assert.deepEqual([await seen(page), await seen(other.page)], [["collision"], []]);
  const strips = () =>
    page.evaluate(() =>
      window.crossgait.view.robots.map((robot, i) => ({
        drawn: robot.parent.position.y + robot.bodies[0].position.y,
        away: robot.bodies[0].position.y - window.crossgait.view.strips[i].middle,
        size: window.crossgait.view.motion.scene.standing_height,
      })),
    );
  const [a, b] = await strips();
  assert.ok(a.drawn - b.drawn > 4 * a.size, `strips apart: ${a.drawn}, ${b.drawn}`);
  // Sideways, until they have left the strips that they began on.
  await page.evaluate(() => (window.begun = window.crossgait.view.strips[0].middle));
  await page.keyboard.press("q");
  await page.keyboard.press("q");
  await page.waitForFunction(() => window.crossgait.view.strips[0].middle > window.begun);
  await page.keyboard.press(" ");
  for (const { away, size } of await strips()) assert.ok(Math.abs(away) <= 1.1 * size, `${away} m off its strip`);
  await page.getByLabel("Engine beside it, 1").selectOption("none");
  await other.page.waitForFunction(() => window.crossgait.view.robots.length === 1);
  await page.getByLabel("Ground", { exact: true }).selectOption("flat");
  await page.waitForFunction(() => window.crossgait.frame.terrain === "flat");
  assert.deepEqual(problems, []);
  assert.deepEqual(other.problems, []);
  await page.close();
  await other.page.close();
});

test("sliders set parameters, and pulling at the robot pushes it", async () => {
  const { page, problems } = await openLive();
  await page.keyboard.press("u");
  const slider = page.getByLabel("body height, m");
  await slider.focus();
  const before_ = Number(await slider.inputValue());
  for (let i = 0; i < 5; ++i) await page.keyboard.press("ArrowLeft");
  const index = await page.evaluate(() =>
    window.crossgait.options.parameters.findIndex((p) => p.name === "body_height"),
  );
  await page.waitForFunction(([i, value]) => window.crossgait.frame.parameters[i] < value - 1e-4, [index, before_]);
  await page.evaluate(() => document.activeElement.blur());
  const gait = page.getByLabel("Gait", { exact: true });
  await gait.selectOption("walk");
  await page.waitForFunction(() => window.crossgait.frame.gait === "walk");
  await gait.selectOption("auto");
  await page.waitForFunction(
    () =>
      window.crossgait.frame.chosen === "auto" && document.querySelector("header").textContent.includes("auto: walk"),
  );
  await page.getByLabel("Swing curve").selectOption("matched");
  await page.waitForFunction(() => window.crossgait.frame.curve === "matched");
  const posts = [];
  page.on("request", (request) => request.method() === "POST" && posts.push(request.postDataJSON()));
  const place = await placeOfBase(page);
  await page.mouse.move(...place);
  await page.mouse.down();
  await page.mouse.move(place[0] + 60, place[1], { steps: 4 });
  await page.mouse.up();
  for (let i = 0; i < 100 && !posts.some((post) => post.do === "push"); ++i) await page.waitForTimeout(50);
  const push = posts.find((post) => post.do === "push");
  assert.ok(push && Math.hypot(...push.impulse) > 0, `among ${JSON.stringify(posts)}`);
  assert.deepEqual(problems, []);
  await page.close();
});

test("time is stopped, stepped, slowed and turned back", async () => {
  const { page, problems } = await openLive();
  await page.evaluate(() => document.activeElement.blur());
  await page.waitForFunction(() => window.crossgait.frame.back > 1.5);
  await page.keyboard.press("p");
  await page.waitForFunction(() => window.crossgait.frame.paused);
  const stopped = (await frame(page)).robots[0].time;
  await page.keyboard.press(".");
  await page.waitForFunction((t) => window.crossgait.frame.robots[0].time > t, stopped);
  const stepped = (await frame(page)).robots[0].time;
  assert.ok(stepped - stopped < 0.0021, `${stepped - stopped} s in a step`);
  await page.keyboard.press(",");
  await page.waitForFunction((t) => window.crossgait.frame.robots[0].time < t, stopped - 0.8);
  await page.getByLabel(/^Pace/).selectOption("0.1");
  await page.waitForFunction(() => window.crossgait.frame.pace === 0.1);
  await page.keyboard.press("p");
  await page.waitForFunction(() => !window.crossgait.frame.paused && window.crossgait.frame.rate < 0.2);
  await page.getByLabel(/^Pace/).selectOption("1");
  await page.waitForFunction(() => window.crossgait.frame.pace === 1);
  assert.deepEqual(problems, []);
  await page.close();
});

test("the world is changed by sliders, and what came of it is plotted", async () => {
  const { page, problems } = await openLive();
  await page.getByLabel("Engine beside it, 1").selectOption(engines[0]);
  await page.waitForFunction(() => window.crossgait.frame.robots.length === 2);
  const friction = page.getByLabel("friction", { exact: true });
  await friction.focus();
  for (let i = 0; i < 5; ++i) await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => window.crossgait.frame.changes.some((change) => change.startsWith("friction=0.")));
  await page.getByLabel("mass, times", { exact: true }).focus();
  for (let i = 0; i < 5; ++i) await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => window.crossgait.frame.changes.some((change) => change.startsWith("mass=x1.")));
  assert.equal((await frame(page)).changes.length, 2);
  for (const [signal, part] of [
    ["torque", "1"],
    ["load of a foot", "2"],
    ["gap from the first", null],
  ]) {
    await page.getByLabel("What is plotted").selectOption(signal);
    if (part) await page.getByLabel("Of which leg or joint").selectOption(part);
    assert.equal(await page.getByLabel("Of which leg or joint").isVisible(), part !== null);
    await page.locator(".live-plot canvas").waitFor();
  }
  await page.getByLabel("as at first: the world").click();
  await page.waitForFunction(() => window.crossgait.frame.changes.length === 0);
  await page.getByLabel(/^keep the last minute/).click();
  await page.waitForFunction(() => window.crossgait.frame.reports > 0);
  await page.getByLabel("Engine beside it, 1").selectOption("none");
  await page.waitForFunction(() => window.crossgait.frame.robots.length === 1);
  assert.deepEqual(problems, []);
  await page.close();
});

test("a spring holds the robot while the pointer does", async () => {
  const { page, problems } = await openLive();
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("u");
  await page.getByText("spring", { exact: true }).click();
  const [x, y] = await placeOfBase(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y - 120, { steps: 4 });
  await page.waitForFunction(() => window.crossgait.frame.pull !== null);
  await page.waitForFunction(() =>
    /^a spring pulls with \d+\.\d N$/.test(document.querySelector(".trouble").textContent),
  );
  await page.mouse.up();
  await page.waitForFunction(() => window.crossgait.frame.pull === null);
  await page.waitForFunction(() => document.querySelector(".trouble").textContent === "");
  assert.deepEqual(problems, []);
  await page.close();
});

test("what is refused is said, and text is text", async () => {
  const { page } = await openLive();
  await page.getByLabel("Parameters of the ground").fill("<b id=hostile>=1");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector(".trouble").textContent.includes("hostile"));
  assert.equal(await page.locator("#hostile").count(), 0);
  await page.close();
});

test("a recording is saved as a report that replays", async () => {
  const { page, problems } = await openLive();
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("r");
  await page.waitForFunction(() => window.crossgait.frame.recorded > 0.5);
  await page.keyboard.press("r");
  await page.waitForFunction(() => window.crossgait.frame.reports > 0);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("save the report").click()]);
  const folder = mkdtempSync(join(tmpdir(), "crossgait-live-"));
  const file = join(folder, "live.html");
  await download.saveAs(file);
  assert.ok(!readFileSync(file, "utf8").includes("connect-src"), "a report may ask nobody");
  await page.goto(`file://${file}`);
  await page.waitForFunction(() => window.crossgait?.player);
  assert.match(await page.title(), /driven by hand/);
  const [seconds, robots] = await page.evaluate(() => [
    window.crossgait.player.end - window.crossgait.player.begin,
    window.crossgait.view.robots.length,
  ]);
  assert.ok(seconds > 0.4 && robots === 1, `${seconds} s of ${robots} robots`);
  rmSync(folder, { recursive: true });
  assert.deepEqual(problems, []);
  await page.close();
});

test("whoever has not the address gets nothing", async () => {
  const { origin } = new URL(address);
  for (const path of ["/", "/frames", `/${"0".repeat(32)}/`]) assert.equal((await fetch(origin + path)).status, 403);
  assert.equal((await command({ do: "drive", vx: 99, vy: 0, yaw_rate: 0 })).status, 400);
  const foreign = await fetch(`${address}command`, {
    method: "POST",
    headers: { "Content-Type": "application/json", Origin: "http://evil.example" },
    body: "{}",
  });
  assert.equal(foreign.status, 403);
});

test("nobody is answered beyond the address of the loopback interface", async () => {
  const { port, pathname } = new URL(address);
  // The first is this machine's, too, and answers where a server listens on all addresses.
  const outer = Object.values(networkInterfaces()).flat();
  const hosts = ["127.0.0.2", ...outer.filter((at) => at.family === "IPv4" && !at.internal).map((at) => at.address)];
  for (const host of hosts)
    await assert.rejects(
      fetch(`http://${host}:${port}${pathname}`),
      (error) => error.cause.code === "ECONNREFUSED",
      host,
    );
});
