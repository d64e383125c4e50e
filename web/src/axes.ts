// What axes of charts and plots show: ranges, numbers, powers of ten, time.
import uPlot from "uplot";
import { theme } from "./theme";

/** Smallest ranges of what is plotted, by unit: below them is what nobody would act on. */
export const FLOORS: Record<string, number> = {
  deg: 0.1,
  "deg/s": 1,
  rad: 1e-3,
  m: 1e-3,
  mm: 0.1,
  "m/s": 1e-3,
  N: 0.1,
  "N m": 1e-3,
};

/** What an axis shows of values from `low` to `high`. */
export function rangeOf(low: number | null, high: number | null, floor: number): [number, number] {
  if (low === null || high === null) return [0, floor || 1];
  if (high - low >= floor && high > low) return uPlot.rangeNum(low, high, 0.1, true) as [number, number];
  const half = 0.5 * Math.max(floor, high - low) || 0.5;
  const middle = 0.5 * (low + high);
  return Math.abs(middle) < half ? [-half, half] : [middle - half, middle + half];
}

/** How every axis looks. */
export const AXIS: uPlot.Axis = {
  stroke: () => theme.variable("--muted"),
  grid: { stroke: () => theme.variable("--rule"), width: 1 },
  ticks: { stroke: () => theme.variable("--rule"), width: 1, size: 4 },
  font: "11px system-ui, sans-serif",
};

/** A number at an axis, which has little room. */
export function short(value: number): string {
  const size = Math.abs(value);
  return (size >= 1e4 || (size > 0 && size < 1e-3) ? value.toExponential() : String(+value.toPrecision(6))).replaceAll(
    "-",
    "\u2212",
  );
}

/** A logarithmic axis marks powers of ten. */
export const POWERS: uPlot.Axis = {
  splits: (_u, _axis, low, high) => powers(low, high),
  filter: (_, at) => at, // they are few already
  values: (_, at) => at.map((v) => v.toExponential(0).replaceAll("-", "\u2212")),
};

/** Powers of ten between two numbers, at most eight, evenly apart; where there are none or one, with their doubles and halves. */
function powers(low: number, high: number): number[] {
  if (Math.log10(high / low) < 2) {
    const at: number[] = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); ++e) at.push(...[1, 2, 5].map((m) => m * 10 ** e));
    return at.filter((v) => v >= low && v <= high);
  }
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  const apart = Math.max(1, Math.ceil((last - first) / 7));
  const found: number[] = [];
  for (let exponent = first; exponent <= last; exponent += apart) found.push(10 ** exponent);
  return found;
}

/** @param begin  of the motion, since which time is told */
export function timeAxes(unit: string, begin: number): uPlot.Axis[] {
  const common = AXIS;
  const time: uPlot.Axis = {
    ...common,
    size: 24,
    gap: 2,
    splits: (_u, _axis, low, high, apart) => {
      const at: number[] = [];
      for (let k = Math.ceil((low - begin) / apart - 1e-6); begin + k * apart <= high; ++k) at.push(begin + k * apart);
      return at;
    },
    values: (_, at) => at.map((t) => `${+(t - begin).toFixed(4)} s`),
  };
  return [time, { ...common, size: unit === "legs" ? 34 : 52, gap: 3, values: (_, at) => at.map(short) }];
}
