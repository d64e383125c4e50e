// The replays of a page, of which one is shown at a time: robot, transport, plots.
import { chartsSection, type ChartFigure } from "./charts";
import { Run, type Motion, type Numbers } from "./document";
import { h } from "./dom";
import { footPaths } from "./feet";
import { Permalink } from "./permalink";
import { Player } from "./player";
import { Plots } from "./plots";
import { Stage } from "./stage";
import { constants } from "./tables";
import { theme } from "./theme";

const MOST_BUTTONS = 6; // beyond them a list takes less room

/** One motion, until another takes its place. */
class Replay {
  readonly runs: Run[];
  readonly player: Player;
  readonly stage: Stage;
  readonly plots: Plots;
  readonly feet: ChartFigure[];
  /** What stands beside the stage. */
  readonly results: HTMLElement[];
  private readonly ending = new AbortController();

  constructor(
    private readonly motion: Motion,
    numbers: Numbers,
  ) {
    const end = this.ending.signal;
    const runs = motion.runs.map((run, index) => new Run(index, run, numbers));
    const longest = runs.reduce((a, b) => (b.time[b.time.length - 1]! > a.time[a.time.length - 1]! ? b : a));
    this.runs = runs;
    this.player = new Player(longest.time);
    theme.setRuns(runs.map((run) => run.name));
    this.stage = new Stage(motion, runs, numbers, this.player, end);
    this.plots = new Plots(motion, runs, numbers, this.player, end);
    const feet = chartsSection("Paths of the feet in the leg frames", footPaths(motion, runs), numbers)!;
    this.feet = feet.figures;
    this.results = [this.plots.element, feet.element, constants(motion)].filter((e) => e !== null);
    const said = notes(motion);
    if (said) this.stage.element.append(said);
  }

  /** Once it is on the page, without which its controls do nothing: shows what the address says. */
  followAddress(): void {
    new Permalink(this.stage, this.player, this.runs, this.motion.name, this.ending.signal);
  }

  end(): void {
    this.player.playing = false;
    this.ending.abort();
    for (const element of [this.stage.element, ...this.results]) element.remove();
  }
}

/** Beside the picture: what in it is not as it is, of a mesh that could not be read for example. */
function notes(motion: Motion): HTMLElement | null {
  const all = [...motion.notes, ...motion.scene.notes];
  if (all.length === 0) return null;
  return h(
    "details",
    { class: "notes" },
    h("summary", {}, `${all.length} rendering ${all.length === 1 ? "note" : "notes"}`),
    h("ul", {}, ...all.map((note) => h("li", {}, note))),
  );
}

export class Replays {
  current: Replay;
  private index: number;
  /** In front of which results stand. */
  private readonly behind = h("span", { hidden: true });
  private readonly chooser: HTMLElement | null;

  /** @param page  that gets the stage  @param results  that gets what stands beside it, at its present end */
  constructor(
    private readonly motions: Motion[],
    private readonly numbers: Numbers,
    private readonly page: HTMLElement,
    results: HTMLElement,
  ) {
    results.append(this.behind);
    this.chooser = motions.length > 1 ? this.makeChooser() : null;
    this.index = this.asked() ?? 0;
    this.current = this.make();
    addEventListener("hashchange", () => this.choose(this.asked() ?? this.index));
  }

  choose(index: number): void {
    if (index === this.index) return;
    this.index = index;
    const focused = document.activeElement; // moves, with what it is in
    this.current.end();
    this.current = this.make();
    if (this.chooser?.contains(focused)) (focused as HTMLElement).focus();
  }

  /** By the address. */
  private asked(): number | null {
    const name = new URLSearchParams(location.hash.slice(1)).get("replay");
    const index = this.motions.findIndex((motion) => motion.name === name);
    return index < 0 ? null : index;
  }

  private make(): Replay {
    const replay = new Replay(this.motions[this.index]!, this.numbers);
    this.page.querySelector(".results")!.before(replay.stage.element);
    this.behind.before(...replay.results);
    replay.followAddress();
    if (this.chooser) {
      replay.stage.element.prepend(this.chooser);
      for (const [i, button] of [...this.chooser.querySelectorAll("button")].entries())
        button.setAttribute("aria-pressed", String(i === this.index));
      const list = this.chooser.querySelector("select");
      if (list) list.selectedIndex = this.index;
    }
    return replay;
  }

  private makeChooser(): HTMLElement {
    const names = this.motions.map((motion) => motion.name);
    if (names.length > MOST_BUTTONS) {
      const list = h(
        "select",
        { change: () => this.choose(list.selectedIndex) },
        ...names.map((name) => h("option", {}, name)),
      );
      return h("label", { class: "replays" }, "replay", list);
    }
    return h(
      "div",
      { class: "chooser replays", role: "group", "aria-label": "What is replayed" },
      ...names.map((name, i) => h("button", { click: () => this.choose(i) }, name)),
    );
  }
}
