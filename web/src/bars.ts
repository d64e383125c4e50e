// Estimates with their intervals as bars over one axis, a row of a table each.
import type { Interval } from "./document";
import { digits, h, svg } from "./dom";
import { HEIGHT, WIDTH, intervalPicture, scalePicture } from "./interval_row";

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
    const [x, width] = [Math.min(zero, estimate), Math.abs(estimate - zero)];
    return intervalPicture(
      `${digits(row.estimate)}, from ${digits(row.low)} to ${digits(row.high)}`,
      [low, estimate, high],
      zero,
      svg("rect", { x, y: HEIGHT / 2 - 5, width, height: 10, class: "bar" }),
    );
  }

  /** Below the last row: zero and the ends. */
  scale(): SVGElement {
    const ends = [this.low, 0, this.high].filter((at, i, all) => all.indexOf(at) === i);
    return scalePicture(
      ends.map((at) => ({
        x: this.x(at),
        text: digits(at),
        anchor: at === this.high ? "end" : at === this.low ? "start" : "middle",
      })),
    );
  }

  private x(value: number): number {
    return ASIDE + ((value - this.low) / (this.high - this.low)) * (WIDTH - 2 * ASIDE);
  }
}
