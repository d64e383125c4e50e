// The support polygon: what the loaded feet span on the ground, and the centre of mass above it.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  Vector3,
  type Object3D,
} from "three";
import type { Run, Scene } from "./document";

const LIFT = 1e-3; // above the ground, by standing heights: it is to be seen

/** Indices of the corners of the convex hull of points in the plane, counterclockwise (Andrew's monotone chain, 1979). */
export function hull(points: [number, number][]): number[] {
  const order = points.map((_, i) => i).sort((a, b) => points[a]![0] - points[b]![0] || points[a]![1] - points[b]![1]);
  const turn = (o: number, a: number, b: number) => {
    const [p, q, r] = [points[o]!, points[a]!, points[b]!];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  };
  const half = (indices: number[]) => {
    const chain: number[] = [];
    for (const i of indices) {
      while (chain.length > 1 && turn(chain[chain.length - 2]!, chain[chain.length - 1]!, i) <= 0) chain.pop();
      chain.push(i);
    }
    return chain.slice(0, -1);
  };
  return points.length < 3 ? order : [...half(order), ...half([...order].reverse())];
}

export class Support extends Group {
  /** Corners of the polygon in the world, m; fewer than three where it is a line, a point or nothing. */
  corners: Vector3[] = [];
  /** In the world, m. */
  readonly centreOfMass = new Vector3();
  private readonly area: Mesh;
  private readonly edge: Line;
  private readonly centre: Mesh;
  private readonly fill = new MeshBasicMaterial({
    transparent: true,
    opacity: 0.25,
    side: DoubleSide,
    depthWrite: false,
  });
  private readonly line = new LineBasicMaterial();
  private readonly points: Float32Array;

  constructor(
    private readonly scene: Scene,
    private readonly size: number,
  ) {
    super();
    this.points = new Float32Array(3 * (scene.legs.length + 1));
    const attribute = new BufferAttribute(this.points, 3);
    const [surface, outline] = [new BufferGeometry(), new BufferGeometry()];
    surface.setAttribute("position", attribute);
    outline.setAttribute("position", attribute);
    const fan: number[] = [];
    for (let i = 1; i + 1 < scene.legs.length; ++i) fan.push(0, i, i + 1);
    surface.setIndex(fan);
    this.area = new Mesh(surface, this.fill);
    this.edge = new Line(outline, this.line);
    this.centre = new Mesh(new RingGeometry(0.035 * size, 0.06 * size, 24), this.fill.clone());
    (this.centre.material as MeshBasicMaterial).opacity = 0.9;
    this.area.frustumCulled = this.edge.frustumCulled = false; // they move
    this.add(this.area, this.edge, this.centre);
  }

  paint(colour: Color): void {
    this.fill.color.copy(colour);
    this.line.color.copy(colour);
    (this.centre.material as MeshBasicMaterial).color.copy(colour);
  }

  show(run: Run, frame: number, bodies: Object3D[]): void {
    const { legs } = this.scene;
    const loaded: Vector3[] = [];
    legs.forEach((leg, index) => {
      const at = 3 * (frame * legs.length + index);
      if (Math.hypot(run.forces[at]!, run.forces[at + 1]!, run.forces[at + 2]!) === 0) return;
      loaded.push(new Vector3(run.feet[at], run.feet[at + 1], run.feet[at + 2]! - leg.radius + LIFT * this.size));
    });
    this.corners = hull(loaded.map((p) => [p.x, p.y])).map((i) => loaded[i]!);
    const count = this.corners.length;
    [...this.corners, ...this.corners.slice(0, 1)].forEach((p, i) => p.toArray(this.points, 3 * i));
    for (const { geometry } of [this.area, this.edge]) geometry.attributes.position!.needsUpdate = true;
    this.area.geometry.setDrawRange(0, 3 * Math.max(0, count - 2));
    this.edge.geometry.setDrawRange(0, count > 1 ? count + 1 : 0);
    this.showCentre(bodies);
  }

  private showCentre(bodies: Object3D[]): void {
    let mass = 0;
    this.centreOfMass.set(0, 0, 0);
    const local = new Vector3();
    this.scene.bodies.forEach((body, i) => {
      local
        .set(...body.centre_of_mass)
        .applyQuaternion(bodies[i]!.quaternion)
        .add(bodies[i]!.position);
      this.centreOfMass.addScaledVector(local, body.mass);
      mass += body.mass;
    });
    if (mass > 0) this.centreOfMass.divideScalar(mass);
    // On the ground between the feet.
    const height = this.corners.reduce((sum, p) => sum + p.z, 0) / (this.corners.length || 1);
    this.centre.visible = this.corners.length > 0;
    this.centre.position.set(this.centreOfMass.x, this.centreOfMass.y, height + LIFT * this.size);
  }
}
