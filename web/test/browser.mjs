// Debian's Chromium, as the tests of pages use it.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const arguments_ = [
  "--headless",
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

// Software rendering has a word to say about reading pixels back, which nothing here is to blame for.
function isOfTheDriver(text) {
  return text.includes("GPU stall due to ReadPixels");
}

/** To be run before a page: it finds no WebGL. A picture by software takes a second each; what is around it is the same
 * without. */
export const withoutPicture = () => {
  const real = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return /webgl/.test(kind) ? null : real.call(this, kind, ...rest);
  };
};
/** What three.js complains of then. */
export const WITHOUT_PICTURE = ["creating WebGL context"];

export class Browser {
  /** @param allowed addresses that pages may ask for  @param expected complaints that are no problem */
  constructor(allowed, expected = []) {
    this.allowed = allowed;
    this.expected = expected;
    this.profile = mkdtempSync(join(tmpdir(), "crossgait-page-"));
  }
  async launch() {
    this.context = await chromium.launchPersistentContext(this.profile, {
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      args: arguments_,
    });
  }
  async close() {
    await this.context?.close();
    rmSync(this.profile, { recursive: true, force: true });
  }

  /** Opens a page; whatever it complains of or asks for that it may not is among the problems.
   *  @param before  is run in the page before anything of it */
  async open(address, { width = 1440, height = 900, scheme = "light", before = null } = {}) {
    const page = await this.context.newPage();
    if (before) await page.addInitScript(before);
    page.setDefaultTimeout(300_000); // pictures take their time without a graphics card, on a machine that has other things to do
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ colorScheme: scheme });
    const problems = [];
    page.on(
      "console",
      (message) =>
        ["error", "warning"].includes(message.type()) &&
        !isOfTheDriver(message.text()) &&
        !this.expected.some((words) => message.text().includes(words)) &&
        problems.push(message.text()),
    );
    page.on("pageerror", (error) => problems.push(error.message));
    page.on("request", (request) => this.allowed.test(request.url()) || problems.push(`fetched ${request.url()}`));
    await page.goto(address);
    await page.waitForFunction(() => window.crossgait);
    return { page, problems };
  }
}
