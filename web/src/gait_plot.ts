// The gait diagram: which feet were on the ground, and which were meant to be.
import uPlot from "uplot";
import type { Motion, Run } from "./document";
import type { SvgContext } from "./figure_file";
import type { Player } from "./player";
import { theme } from "./theme";
import { key, TimePlot } from "./time_plot";

/** Which feet were on the ground, and which were meant to be. */
export class GaitPlot extends TimePlot {
  constructor(
    player: Player,
    private readonly motion: Motion,
    private readonly runs: Run[],
    marks: number[],
  ) {
    const several = runs.length > 1;
    const keys = runs.map((run) =>
      key(several ? run.name : "on the ground", theme.run(run.index).dash, () => theme.runColour(run.index)),
    );
    if (runs[0]!.document.planned) keys.push(key("planned stance", undefined, () => theme.variable("--planned")));
    const shortest = motion.shortest_contact;
    const leftOut = shortest > 0 ? ` (touches and gaps under ${+(1e3 * shortest).toFixed(1)} ms left out)` : "";
    super(
      player,
      `Gait: feet on the ground${leftOut}`,
      "",
      keys,
      marks,
      44 + motion.scene.legs.length * Math.max(26, 12 + 9 * runs.length),
    );
  }

  protected make(width: number): uPlot {
    const { legs } = this.motion.scene;
    const options = this.options(width, "legs", {
      scales: { x: { time: false }, y: { range: [0, legs.length] } },
      series: [{}, { stroke: "transparent", points: { show: false } }],
      hooks: { draw: [(u) => this.drawBars(u)] },
    });
    options.axes![1]!.splits = () => legs.map((_, i) => legs.length - i - 0.5);
    options.axes![1]!.values = () => legs.map((leg) => leg.name);
    options.axes![1]!.grid = { show: false };
    const time = Array.from(this.player.frames);
    return new uPlot(options, [time, time.map(() => 0)], this.holder);
  }

  private drawBars(u: uPlot): void {
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    this.bars(u, true, (x, y, width, height, colour) => {
      u.ctx.fillStyle = colour;
      u.ctx.fillRect(x, y, width, height);
    });
    u.ctx.restore();
  }
  protected drawSvg(u: uPlot, context: SvgContext): void {
    this.bars(u, false, (x, y, width, height, colour) => {
      context.fillStyle = colour;
      context.rectangle(x, y, width, height);
    });
  }
  /** @param inCanvas  in its pixels, else in those of the page within the axes */
  private bars(
    u: uPlot,
    inCanvas: boolean,
    draw: (x: number, y: number, width: number, height: number, colour: string) => void,
  ): void {
    const { legs } = this.motion.scene;
    const bar = (times: number[] | undefined, top: number, bottom: number, colour: string) => {
      const [y0, y1] = [u.valToPos(top, "y", inCanvas), u.valToPos(bottom, "y", inCanvas)];
      for (let i = 0; i + 1 < (times?.length ?? 0); i += 2) {
        const [x0, x1] = [u.valToPos(times![i]!, "x", inCanvas), u.valToPos(times![i + 1]!, "x", inCanvas)];
        draw(x0, y0, Math.max(1, x1 - x0), y1 - y0, colour);
      }
    };
    legs.forEach((_, leg) => {
      const top = legs.length - leg;
      bar(this.runs[0]!.document.planned?.[leg], top - 0.06, top - 0.94, theme.variable("--planned"));
      const share = 0.68 / this.runs.length;
      this.runs.forEach((run, i) => {
        const y = top - 0.16 - i * share;
        // What is dashed as a line is a thinner bar.
        const thin = theme.run(run.index).dash ? 0.3 : 0.06;
        bar(run.document.contact?.[leg], y - thin * share, y - (1 - thin) * share, theme.runColour(run.index));
      });
    });
  }
}
