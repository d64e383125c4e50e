// Light or dark, as the system has it or as was chosen; and the colours of engines in either.

// Okabe and Ito's palette (2008), which people with any colour vision tell apart;
// its brighter half on dark ground.
const LIGHT = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];
const DARK = ["#56b4e9", "#f0803c", "#2cc79c", "#dd9cc2", "#a5b1ff", "#f0c04a"];

type Name = "light" | "dark";

class Theme {
  private readonly system = matchMedia("(prefers-color-scheme: dark)");
  private chosen: Name | null = null;
  private printing = false;
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
  /** @returns what ends it */
  onChange(listener: () => void): () => void {
    this.listeners.push(listener);
    return () => void this.listeners.splice(this.listeners.indexOf(listener), 1);
  }
  /** Of the n-th run. */
  colour(index: number): string {
    const palette = this.name === "dark" ? DARK : LIGHT;
    return palette[index % palette.length] as string;
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
