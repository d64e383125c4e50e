// Estimates with their intervals as bars over one axis, a row of a table each.
import type { Interval } from "./document";
import { digits, h, svg } from "./dom";

const WIDTH = 230;
const HEIGHT = 22;
const ASIDE = 8; // px beside the outermost ends

export class Bars {
  private readonly low: number;
  private readonly high: number;

  constructor(rows: (Interval | null)[]) {
    const ends = rows.flatMap((row) => (row ? [row.low, row.high, row.estimate] : [])).filter(Number.isFinite);
    this.low = Math.min(0, ...ends);
    this.high = Math.max(0, ...ends);
    if (this.high === this.low) this.high = this.low + 1;
  }

  picture(row: Interval | null): Node {
    if (!row) return h("span", {}, "\u2013");
    const [low, estimate, high, zero] = [row.low, row.estimate, row.high, 0].map((at) => this.x(at)) as [
      number,
      number,
      number,
      number,
    ];
    const middle = HEIGHT / 2;
    return svg(
      "svg",
      {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        width: WIDTH,
        height: HEIGHT,
        role: "img",
        "aria-label": `${digits(row.estimate)}, from ${digits(row.low)} to ${digits(row.high)}`,
      },
      svg("rect", {
        x: Math.min(zero, estimate),
        y: middle - 5,
        width: Math.abs(estimate - zero),
        height: 10,
        class: "bar",
      }),
      svg("line", { x1: zero, x2: zero, y1: 0, y2: HEIGHT, class: "zero" }),
      svg("line", { x1: low, x2: high, y1: middle, y2: middle, class: "interval" }),
      svg("circle", { cx: estimate, cy: middle, r: 4, class: "dot" }),
    );
  }

  /** Below the last row: zero and the ends. */
  scale(): SVGElement {
    const ends = [this.low, 0, this.high].filter((at, i, all) => all.indexOf(at) === i);
    return svg(
      "svg",
      { viewBox: `0 0 ${WIDTH} 14`, width: WIDTH, height: 14, "aria-hidden": "true" },
      ...ends.map((at) =>
        svg(
          "text",
          { x: this.x(at), y: 11, "text-anchor": at === this.high ? "end" : at === this.low ? "start" : "middle" },
          digits(at),
        ),
      ),
    );
  }

  private x(value: number): number {
    return ASIDE + ((value - this.low) / (this.high - this.low)) * (WIDTH - 2 * ASIDE);
  }
}
