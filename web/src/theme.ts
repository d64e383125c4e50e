// Light or dark, as the system has it or as was chosen; and the colours of engines in either.

// palette.json is Okabe and Ito's palette (2008), which people with any colour vision tell apart; its brighter half is for
// dark ground.
import palette from "./palette.json";
import { engineStyles, type Style } from "./styles";

type Name = "light" | "dark";

class Theme {
  private readonly system = matchMedia("(prefers-color-scheme: dark)");
  private chosen: Name | null = null;
  private printing = false;
  private runs: Style[] = [];
  private readonly listeners: (() => void)[] = [];

  constructor() {
    this.system.addEventListener("change", () => this.apply());
    addEventListener("beforeprint", () => this.print(true));
    addEventListener("afterprint", () => this.print(false));
    this.apply();
  }

  get name(): Name {
    return this.printing ? "light" : (this.chosen ?? (this.system.matches ? "dark" : "light"));
  }
  toggle(): void {
    this.chosen = this.name === "dark" ? "light" : "dark";
    this.apply();
  }
  /** @param end  ends it  @returns what ends it, too */
  onChange(listener: () => void, end?: AbortSignal): () => void {
    this.listeners.push(listener);
    const stop = () => void this.listeners.splice(this.listeners.indexOf(listener), 1);
    end?.addEventListener("abort", stop);
    return stop;
  }
  /** Of the palette. */
  colour(slot: number): string {
    const colours = palette[this.name];
    return colours[slot % colours.length] as string;
  }
  /** Before anything is drawn: the runs of the page, by name. */
  setRuns(names: string[]): void {
    this.runs = engineStyles(names);
  }
  /** Of the n-th run. */
  run(index: number): Style {
    return this.runs[index] ?? { slot: index, dash: undefined };
  }
  runColour(index: number): string {
    return this.colour(this.run(index).slot);
  }
  variable(name: string): string {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  private print(on: boolean): void {
    this.printing = on;
    this.apply();
  }
  private apply(): void {
    document.documentElement.dataset.theme = this.name;
    for (const listener of this.listeners) listener();
  }
}

export const theme = new Theme();
