// A verdict: every statistic as a dot with its interval between the limits, the words, and what the gap comes from.
import type { Verdict } from "./document";
import { digits, h, scroller, svg, typeset } from "./dom";
import { HEIGHT, WIDTH, intervalPicture, scalePicture } from "./interval_row";

type Statistic = Verdict["statistics"][number];

/** Gaps in margins, over the whole range: linear within the margin, then by powers of ten. */
class Axis {
  private readonly reach: number;

  constructor(verdict: Verdict) {
    let reach = 3;
    for (const s of verdict.statistics)
      if (s.margin > 0) reach = Math.max(reach, Math.abs(s.low) / s.margin, Math.abs(s.high) / s.margin);
    this.reach = Math.asinh(Number.isFinite(reach) ? reach : 1e6);
  }
  x(margins: number): number {
    return WIDTH / 2 + (Math.asinh(margins) / this.reach) * (WIDTH / 2 - 6);
  }
  picture(s: Statistic): SVGElement {
    const [from, to] = [this.x(-1), this.x(1)];
    const [low, gap, high] = [s.low, s.gap, s.high].map((at) => this.x(s.margin > 0 ? at / s.margin : 0)) as [
      number,
      number,
      number,
    ];
    return intervalPicture(
      `${digits(s.gap)}, from ${digits(s.low)} to ${digits(s.high)}; margin ${digits(s.margin)}`,
      [low, gap, high],
      WIDTH / 2,
      svg("rect", { x: from, y: 0, width: to - from, height: HEIGHT, class: "within" }),
      s.word,
    );
  }
  /** Below the last row: zero and the margins. */
  scale(): SVGElement {
    const ticks = [-10, -1, 0, 1, 10].filter((at) => Math.abs(this.x(at) - WIDTH / 2) <= WIDTH / 2 - 6);
    return scalePicture(ticks.map((at) => ({ x: this.x(at), text: `${at}`.replace("-", "\u2212"), anchor: "middle" })));
  }
}

function attribution(verdict: Verdict): HTMLElement | null {
  const a = verdict.attribution;
  if (!a) return null;
  const names = [...new Set(a.factors.map((f) => f.group))];
  const rows = a.statistics.map((s) => {
    const cells = names.map((name) => {
      const effect = s.groups.find((g) => g.name === name)?.effect;
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
  const sentences = a.statistics
    .filter((s) => s.sentence)
    .map((s) => h("li", {}, typeset(`${s.name}: ${s.sentence}.`)));
  return h(
    "div",
    {},
    h("h3", {}, `What the gap comes from: ${a.from} to ${a.to}`),
    sentences.length > 0 ? h("ul", {}, ...sentences) : null,
    scroller(
      "What the gap comes from",
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
      "Part of the gap that each modelling decision makes, in the statistic's unit; those that lead are marked.",
    ),
    h("dl", {}, ...a.factors.flatMap((f) => [h("dt", {}, f.name), h("dd", {}, f.summary)])),
  );
}

/** Where the verdict of two engines is on the page, either way round. */
export function verdictPlace(a: string, b: string): string {
  return `verdict ${[a, b].sort().join(" ")}`;
}

/** Opens the verdict of two engines, and goes there. */
export function openVerdict(a: string, b: string): void {
  const section = document.getElementById(verdictPlace(a, b));
  const details = section?.querySelector("details");
  if (!section || !details) return;
  details.open = true;
  section.scrollIntoView();
}

/** @param folded  until it is opened */
export function verdictSection(verdict: Verdict, folded: boolean): HTMLElement {
  const axis = new Axis(verdict);
  const [a, b] = verdict.engines;
  const header = ["statistic", "word", a, b, "gap", "from", "to", "margin", "gap in margins", "half the step"];
  const rows = verdict.statistics.map((s) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, s.unit === "-" ? s.name : `${s.name}, ${s.unit}`),
      h("td", { title: s.reason }, h("span", { class: `word ${s.word}` }, s.word)),
      ...[...s.values, s.gap, s.low, s.high].map((value) => h("td", {}, digits(value))),
      h("td", { title: s.margin_rule }, digits(s.margin)),
      h("td", { class: "picture" }, axis.picture(s)),
      h("td", {}, s.gap_half === null ? "\u2013" : digits(s.gap_half)),
    ),
  );
  const reasons = verdict.statistics
    .filter((s) => s.reason)
    .map((s) => h("li", {}, typeset(`${s.name}: ${s.word}: ${s.reason}.`)));
  const scale = h(
    "tr",
    { class: "scale" },
    h("td", { colspan: 8 }),
    h("td", { class: "picture" }, axis.scale()),
    h("td"),
  );
  const models = verdict.models.map((m) =>
    h(
      "li",
      {},
      `${m.quantity} of ${m.element}: ${digits(m.a)} and ${digits(m.b)}${m.unit === "-" ? "" : ` ${m.unit}`}`,
    ),
  );
  const heading = h("h2", {}, `${a} and ${b} `, h("span", { class: `word ${verdict.word}` }, verdict.word));
  const parts = [
    h(
      "p",
      {},
      `${verdict.behaviour}, ${verdict.starts} starts. Engines agree where the gap lies within its margin (shaded), and differ where it lies beyond, with ${100 * verdict.confidence} % confidence for all together. ${a}: ${verdict.outcomes[0]}; ${b}: ${verdict.outcomes[1]}.`,
    ),
    scroller(
      `${a} and ${b}`,
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
      `Run: ${verdict.variations.join(", ")}${verdict.left_out.length > 0 ? `; left out: ${verdict.left_out.join("; ")}` : ""}.`,
    ),
    reasons.length > 0 ? h("ul", { class: "muted" }, ...reasons) : null,
    models.length > 0
      ? h("div", {}, h("h3", {}, "The two engines hold different machines"), h("ul", {}, ...models))
      : null,
    attribution(verdict),
  ].filter((part) => part !== null);
  const id = verdictPlace(a, b);
  if (!folded) return h("section", { class: "group verdict", id }, heading, ...parts);
  return h("section", { class: "group verdict", id }, h("details", {}, h("summary", {}, heading), ...parts));
}
