// A verdict: every statistic as a dot with its interval between the limits, the words, and what the gap comes from.
import type { Interval, Verdict } from "./document";
import { digits, h, svg } from "./dom";

const WIDTH = 260;
const HEIGHT = 22;

/** Scores over the whole range: linear within the limits, then by powers of ten. */
class Axis {
  private readonly reach: number;

  constructor(private readonly verdict: Verdict) {
    let reach = 3 * verdict.limit;
    for (const { score } of verdict.statistics) reach = Math.max(reach, Math.abs(score.low), Math.abs(score.high));
    this.reach = this.bent(Number.isFinite(reach) ? reach : 1e6);
  }
  private bent(score: number): number {
    return Math.asinh(score / this.verdict.limit);
  }
  x(score: number): number {
    return WIDTH / 2 + (this.bent(score) / this.reach) * (WIDTH / 2 - 6);
  }
  picture(score: Interval, word: string): SVGElement {
    const { limit } = this.verdict;
    const [from, to] = [this.x(-limit), this.x(limit)];
    const middle = HEIGHT / 2;
    return svg(
      "svg",
      {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        width: WIDTH,
        height: HEIGHT,
        role: "img",
        "aria-label": `${digits(score.estimate)}, from ${digits(score.low)} to ${digits(score.high)}`,
      },
      svg("rect", { x: from, y: 0, width: to - from, height: HEIGHT, class: "within" }),
      svg("line", { x1: WIDTH / 2, x2: WIDTH / 2, y1: 0, y2: HEIGHT, class: "zero" }),
      svg("line", { x1: this.x(score.low), x2: this.x(score.high), y1: middle, y2: middle, class: `interval ${word}` }),
      svg("circle", { cx: this.x(score.estimate), cy: middle, r: 4, class: `dot ${word}` }),
    );
  }
  /** Below the last row: zero and the limits. */
  scale(): SVGElement {
    const { limit } = this.verdict;
    const ticks = [-10 * limit, -limit, 0, limit, 10 * limit].filter(
      (at) => Math.abs(this.x(at) - WIDTH / 2) <= WIDTH / 2 - 6,
    );
    return svg(
      "svg",
      { viewBox: `0 0 ${WIDTH} 14`, width: WIDTH, height: 14, "aria-hidden": "true" },
      ...ticks.map((at) =>
        svg("text", { x: this.x(at), y: 11, "text-anchor": "middle" }, `${at}`.replace("-", "\u2212")),
      ),
    );
  }
}

function attribution(verdict: Verdict): HTMLElement | null {
  const a = verdict.attribution;
  if (!a) return null;
  const names = a.factors.map((f) => f.name);
  const rows = a.statistics.map((s) => {
    const cells = names.map((name) => {
      const effect = s.factors.find((f) => f.name === name)?.effect;
      const leads = s.leading.includes(name);
      return h("td", { class: leads ? "leads" : "" }, effect ? digits(effect.estimate) : "\u2013");
    });
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, s.unit === "-" ? s.name : `${s.name}, ${s.unit}`),
      h("td", {}, digits(s.gap.estimate)),
      ...cells,
    );
  });
  return h(
    "div",
    {},
    h("h3", {}, `What the gap comes from: ${a.from} to ${a.to}, one factor at a time`),
    h(
      "div",
      { class: "scroll" },
      h(
        "table",
        {},
        h("thead", {}, h("tr", {}, ...["statistic", "gap", ...names].map((n) => h("th", { scope: "col" }, n)))),
        h("tbody", {}, ...rows),
      ),
    ),
    h(
      "p",
      { class: "muted" },
      "Share of the gap that each factor makes, in the statistic's unit; those that lead are marked.",
    ),
    h("dl", {}, ...a.factors.flatMap((f) => [h("dt", {}, f.name), h("dd", {}, f.summary)])),
  );
}

export function verdictSection(verdict: Verdict): HTMLElement {
  const axis = new Axis(verdict);
  const header = ["statistic", verdict.a, verdict.b, "gap", "\u00b1", "spread or floor", "gap over it", "verdict"];
  const rows = verdict.statistics.map((s) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, s.unit === "-" ? s.name : `${s.name}, ${s.unit}`),
      h("td", {}, digits(s.mean_a)),
      h("td", {}, digits(s.mean_b)),
      h("td", {}, digits(s.gap.estimate)),
      h("td", {}, digits((s.gap.high - s.gap.low) / 2)),
      h("td", {}, digits(Math.max(s.spread, s.floor))),
      h("td", { class: "picture" }, axis.picture(s.score, s.verdict)),
      h("td", {}, h("span", { class: `word ${s.verdict}` }, s.verdict)),
    ),
  );
  const scale = h(
    "tr",
    { class: "scale" },
    h("td", { colspan: 6 }),
    h("td", { class: "picture" }, axis.scale()),
    h("td", {}),
  );
  const models = verdict.models.map((m) =>
    h(
      "li",
      {},
      `${m.quantity} of ${m.element}: ${digits(m.a)} and ${digits(m.b)}${m.unit === "-" ? "" : ` ${m.unit}`}`,
    ),
  );
  return h(
    "section",
    { class: "group verdict" },
    h("h2", {}, `${verdict.a} and ${verdict.b} `, h("span", { class: `word ${verdict.verdict}` }, verdict.verdict)),
    h(
      "p",
      {},
      `${verdict.behaviour}, ${verdict.starts} starts. The gap between the engines over the spread within each: up to ${verdict.limit} (shaded) they agree. Intervals hold together with ${100 * verdict.confidence} % confidence.`,
    ),
    h(
      "div",
      { class: "scroll" },
      h(
        "table",
        {},
        h("thead", {}, h("tr", {}, ...header.map((text) => h("th", { scope: "col" }, text)))),
        h("tbody", {}, ...rows, scale),
      ),
    ),
    h(
      "p",
      { class: "muted" },
      `Spread over the starts and over: ${verdict.variations.join(", ")}${verdict.left_out.length > 0 ? `; left out: ${verdict.left_out.join("; ")}` : ""}.`,
    ),
    models.length > 0
      ? h("div", {}, h("h3", {}, "The two engines hold different machines"), h("ul", {}, ...models))
      : null,
    attribution(verdict),
  );
}
