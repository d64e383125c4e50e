// How fine the picture is: whole where it stands still; while it moves as coarse as the machine needs to keep up.
import { BufferAttribute, BufferGeometry } from "three";

export interface Level {
  /** Over those of a picture that stands still, along each side. */
  pixels: number;
  /** Whether meshes have few triangles. */
  coarse: boolean;
  /** Pictures to a shadow. */
  shadow: number;
}

/** Of a picture that stands still. */
export const WHOLE: Level = { pixels: 1, coarse: false, shadow: 1 };
/** Of pictures while they move, finest first. */
const LEVELS: Level[] = [
  WHOLE,
  { pixels: 1 / 2, coarse: true, shadow: 1 },
  { pixels: 1 / 3, coarse: true, shadow: 2 },
  { pixels: 1 / 4, coarse: true, shadow: 4 },
];

/** A picture that takes longer than this, ms, is to be coarser: 20 a second are wanted. */
const SLOW = 48;
/** Pictures that come later than this after one another, ms, do not move. */
const STILL = 300;
/** A level is judged after so many pictures, or so many ms. */
const JUDGED = 4;
const JUDGED_AFTER = 300;

/** Knows of pictures when they were drawn, and says how fine the next one is. Once coarser it stays so for motions to come. */
export class Detail {
  private level = 0;
  private last = -Infinity;
  private intervals: number[] = [];
  private timer = 0;

  /** @param still  draws the picture whole, after it has moved */
  constructor(private readonly still: () => void) {}

  /** Of a picture that is drawn now, because something has moved. */
  next(now = performance.now()): Level {
    const interval = now - this.last;
    this.last = now;
    clearTimeout(this.timer);
    if (interval > STILL) {
      this.intervals = [];
      this.timer = 0;
      return WHOLE;
    }
    this.timer = window.setTimeout(() => this.still(), STILL);
    this.intervals.push(interval);
    const passed = this.intervals.reduce((sum, each) => sum + each, 0);
    if (this.intervals.length === JUDGED || passed > JUDGED_AFTER) {
      const median = this.intervals.sort((a, b) => a - b)[Math.floor(this.intervals.length / 2)]!;
      this.intervals = [];
      if (median > SLOW) this.level = Math.min(this.level + 1, LEVELS.length - 1);
    }
    return LEVELS[this.level]!;
  }
  end(): void {
    clearTimeout(this.timer);
  }
}

/**
 * A mesh of fewer triangles: vertices in one cell of a grid become one, in their middle, and triangles that lose a corner go.
 * @param cell in the units of the mesh
 */
export function coarseOf(geometry: BufferGeometry, cell: number): BufferGeometry {
  const points = geometry.getAttribute("position");
  const corners = geometry.index!;
  const cells = new Map<string, number>();
  const sums: number[] = []; // x, y, z and count of each
  const placed = new Uint32Array(points.count);
  for (let i = 0; i < points.count; ++i) {
    const xyz = [points.getX(i), points.getY(i), points.getZ(i)] as const;
    const key = xyz.map((x) => Math.floor(x / cell)).join();
    const at = cells.get(key) ?? cells.size;
    cells.set(key, at);
    placed[i] = at;
    xyz.forEach((x, k) => (sums[4 * at + k] = (sums[4 * at + k] ?? 0) + x));
    sums[4 * at + 3] = (sums[4 * at + 3] ?? 0) + 1;
  }
  const vertices = new Float32Array(3 * cells.size);
  for (let i = 0; i < cells.size; ++i)
    for (let k = 0; k < 3; ++k) vertices[3 * i + k] = sums[4 * i + k]! / sums[4 * i + 3]!;
  const triangles: number[] = [];
  for (let i = 0; i < corners.count; i += 3) {
    const [a, b, c] = [placed[corners.getX(i)]!, placed[corners.getX(i + 1)]!, placed[corners.getX(i + 2)]!];
    if (a !== b && b !== c && c !== a) triangles.push(a, b, c);
  }
  const coarse = new BufferGeometry();
  coarse.setAttribute("position", new BufferAttribute(vertices, 3));
  coarse.setIndex(triangles);
  coarse.computeVertexNormals();
  return coarse;
}
