// How engines look, by their names: the same on every page and in Python's figures (python/crossgait/studies/palette.py).
import palette from "./palette.json";

/** Dashes, px, of a library's first, second and third variant. */
const DASHES: number[][] = [
  [8, 4],
  [2, 3],
  [8, 3, 2, 3],
];

export interface Style {
  /** Of the palette. */
  slot: number;
  /** px; none: solid. */
  dash: number[] | undefined;
}

/** The colour is the library's. An engine as its library has it is solid; the library's others (another law, another
 * release) are dashed, in their order. */
export function engineStyles(names: string[]): Style[] {
  const libraries = names.map((name) => name.split(/[:@+-]/, 1)[0]!);
  const present = [...new Set(libraries)];
  const known = (library: string) => palette.libraries.indexOf(library);
  const taken = present.map(known).filter((slot) => slot >= 0);
  const all = palette.light.map((_, slot) => slot);
  const free = all.filter((slot) => !taken.includes(slot));
  const rest = free.length > 0 ? free : all;
  const others = present.filter((library) => known(library) < 0);
  const variants = new Map<string, number>();
  return names.map((name, i) => {
    const library = libraries[i]!;
    const slot = known(library) >= 0 ? known(library) : rest[others.indexOf(library) % rest.length]!;
    if (name === library) return { slot, dash: undefined };
    const variant = variants.get(library) ?? 0;
    variants.set(library, variant + 1);
    return { slot, dash: DASHES[variant % DASHES.length] };
  });
}
