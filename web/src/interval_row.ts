// The picture in a row of a table: an estimate with its interval, and below the last row what its axis says.
import { svg } from "./dom";

export const WIDTH = 230;
export const HEIGHT = 22;

/** @param around  drawn below the interval  @param word  a class of interval and dot, for their colour */
export function intervalPicture(
  label: string,
  [low, estimate, high]: readonly [number, number, number],
  zero: number,
  around: SVGElement,
  word = "",
): SVGElement {
  const middle = HEIGHT / 2;
  const of = (name: string) => (word === "" ? name : `${name} ${word}`);
  return svg(
    "svg",
    { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, role: "img", "aria-label": label },
    around,
    svg("line", { x1: zero, x2: zero, y1: 0, y2: HEIGHT, class: "zero" }),
    svg("line", { x1: low, x2: high, y1: middle, y2: middle, class: of("interval") }),
    svg("circle", { cx: estimate, cy: middle, r: 4, class: of("dot") }),
  );
}

export interface Tick {
  x: number;
  text: string;
  anchor: "start" | "middle" | "end";
}
export function scalePicture(ticks: Tick[]): SVGElement {
  return svg(
    "svg",
    { viewBox: `0 0 ${WIDTH} 14`, width: WIDTH, height: 14, "aria-hidden": "true" },
    ...ticks.map(({ x, text, anchor }) => svg("text", { x, y: 11, "text-anchor": anchor }, text)),
  );
}
