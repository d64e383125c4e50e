// What the address says behind its #, so that a link leads to the same moment, view and engines: #t=2.3&view=side; of
// several replays also which.
import type { Stage } from "./stage";
import type { Player } from "./player";
import type { Run } from "./document";

const PAUSE = 300; // ms between two changes of the address

export class Permalink {
  private waiting = 0;
  private readonly beside: boolean;

  constructor(
    private readonly stage: Stage,
    private readonly player: Player,
    private readonly runs: Run[],
    private readonly replay: string,
    end: AbortSignal,
  ) {
    this.beside = stage.view?.sideBySide ?? false;
    this.read();
    addEventListener("hashchange", () => this.read(), { signal: end });
    end.addEventListener("abort", () => clearTimeout(this.waiting));
    player.onChange(() => player.playing || this.write());
    if (stage.view) stage.view.viewpoint.onLook = () => this.write();
  }

  private read(): void {
    const said = new URLSearchParams(location.hash.slice(1));
    if ((said.get("replay") ?? this.replay) !== this.replay) return; // of another, which is shown next
    const { view, element } = this.stage;
    const set = (selector: string, on: boolean) => {
      const box = element.querySelector<HTMLInputElement>(`${selector} input`);
      if (box && box.checked !== on) box.click();
    };
    const engines = said.get("engines")?.split(",");
    // Names that nobody knows hide nobody.
    if (engines && this.runs.some((run) => engines.includes(run.name)))
      for (const run of this.runs) set(`[data-run="${CSS.escape(run.name)}"]`, engines.includes(run.name));
    if (said.has("beside")) set("#layout", said.get("beside") === "1");
    const time = Number(said.get("t") ?? NaN);
    if (Number.isFinite(time)) {
      this.player.playing = false;
      this.player.seek(this.player.begin + time);
    }
    const direction = said.get("view");
    if (view && direction) view.viewpoint.direction = direction;
  }

  private write(): void {
    clearTimeout(this.waiting);
    this.waiting = window.setTimeout(() => {
      const { view } = this.stage;
      const parts = [`t=${+this.player.since(this.player.time).toFixed(3)}`];
      if (this.replay) parts.push(`replay=${encodeURIComponent(this.replay)}`);
      if (view) {
        parts.push(`view=${view.viewpoint.direction}`);
        if (!view.shown.every(Boolean)) {
          const shown = this.runs.filter((_, i) => view.shown[i]).map((run) => encodeURIComponent(run.name));
          parts.push(`engines=${shown.join(",")}`);
        }
        if (view.sideBySide !== this.beside) parts.push(`beside=${Number(view.sideBySide)}`);
      }
      history.replaceState(null, "", `#${parts.join("&")}`);
    }, PAUSE);
  }
}
