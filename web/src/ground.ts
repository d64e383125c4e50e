// The ground as triangles and the lines on it, by which one sees who moves over it.
import { BufferAttribute, BufferGeometry } from "three";
import type { Ground, Numbers } from "./document";

/** Corners of the field and what lies between them. */
export function fieldGeometry(
  ground: Ground,
  numbers: Numbers,
  low: number,
  high: number,
): { geometry: BufferGeometry; points: Float32Array; rows: number } {
  const heights = numbers.floats(ground.heights);
  // Rows within [low, high] along y, two at least.
  const first = Math.max(0, Math.min(ground.rows - 2, Math.floor((low - ground.y) / ground.cell_y)));
  const last = Math.max(first + 1, Math.min(ground.rows - 1, Math.ceil((high - ground.y) / ground.cell_y)));
  const { columns } = ground;
  const rows = last - first + 1;
  const points = new Float32Array(3 * columns * rows);
  const shades = new Float32Array(3 * columns * rows);
  let lowest = Infinity;
  let highest = -Infinity;
  for (const height of heights) {
    lowest = Math.min(lowest, height);
    highest = Math.max(highest, height);
  }
  for (let r = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const at = 3 * (r * columns + c);
      const height = heights[(first + r) * columns + c] as number;
      points.set([ground.x + c * ground.cell_x, ground.y + (first + r) * ground.cell_y, height], at);
      const shade = 0.72 + (0.28 * (height - lowest)) / Math.max(1e-9, highest - lowest);
      shades.fill(shade, at, at + 3);
    }
  }
  const triangles = new Uint32Array(6 * (columns - 1) * (rows - 1));
  let k = 0;
  for (let r = 0; r + 1 < rows; ++r) {
    for (let c = 0; c + 1 < columns; ++c) {
      const a = r * columns + c;
      // Split along (c, r)-(c + 1, r + 1), as the engines do.
      triangles.set([a, a + 1, a + columns + 1, a, a + columns + 1, a + columns], k);
      k += 6;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setAttribute("color", new BufferAttribute(shades, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.computeVertexNormals();
  return { geometry, points, rows };
}

/** Lines at every `apart` or so, along the corners of a field, so that it can be seen who moves over it. */
export function fieldGrid(ground: Ground, points: Float32Array, rows: number, apart: number): BufferGeometry {
  const { columns } = ground;
  const [overX, overY] = [ground.cell_x, ground.cell_y].map((cell) => Math.max(1, Math.round(apart / cell)));
  const [firstX, firstY] = [ground.x / ground.cell_x, points[1]! / ground.cell_y].map(Math.round);
  const index: number[] = [];
  for (let r = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const at = r * columns + c;
      if ((firstY! + r) % overY! === 0 && c + 1 < columns) index.push(at, at + 1);
      if ((firstX! + c) % overX! === 0 && r + 1 < rows) index.push(at, at + columns);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(index), 1));
  return geometry;
}

/** Lines at every `apart`, a little above a plane. */
export function gridGeometry(x0: number, x1: number, y0: number, y1: number, apart: number): BufferGeometry {
  const points: number[] = [];
  const z = 2e-4;
  // In pieces: some graphics drivers leave out a line of which one end is behind the camera.
  const pieces = (from: number, to: number, add: (a: number, b: number) => void) => {
    const count = Math.ceil((to - from) / (10 * apart));
    for (let i = 0; i < count; ++i) add(from + ((to - from) * i) / count, from + ((to - from) * (i + 1)) / count);
  };
  for (let x = Math.ceil(x0 / apart); x * apart <= x1; ++x)
    pieces(y0, y1, (a, b) => points.push(x * apart, a, z, x * apart, b, z));
  for (let y = Math.ceil(y0 / apart); y * apart <= y1; ++y)
    pieces(x0, x1, (a, b) => points.push(a, y * apart, z, b, y * apart, z));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  return geometry;
}
