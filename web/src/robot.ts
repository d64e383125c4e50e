// A run's robot, its feet's paths and the forces on them, as objects of three.js.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  ConeGeometry,
  CylinderGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  Quaternion,
  Vector3,
} from "three";
import { coarseOf } from "./detail";
import type { Numbers, Run, Scene, Shape } from "./document";
import { geometryOf } from "./geometry";
import { INSIDES, Insides, type Inside } from "./insides";
import { Support } from "./support";

const PLAIN: [number, number, number, number] = [0.62, 0.64, 0.67, 1];
/** Length of a foot's path behind it, s. */
const TRAIL = 1.2;
const UP = new Vector3(0, 0, 1);
const POSE = 7; // numbers

/** Meshes of more triangles have a coarse picture, of cells of this share of a standing height. */
const FINE = 500;
const CELL = 0.05;

interface Part {
  body: number;
  shape: Shape;
  geometry: BufferGeometry;
}

/** What the runs of one page share. */
export class RobotParts {
  readonly shapes: Part[] = [];
  private readonly coarse = new Map<Part, BufferGeometry>();

  constructor(
    readonly scene: Scene,
    readonly numbers: Numbers,
  ) {
    scene.bodies.forEach((body, index) => {
      for (const shape of body.shapes)
        this.shapes.push({ body: index, shape, geometry: geometryOf(shape, scene, numbers) });
    });
  }

  /** What is drawn of a part in a coarse picture; made when it is first wanted. */
  coarseOf(part: Part): BufferGeometry {
    const corners = part.shape.type === "mesh" ? part.geometry.index!.count : 0;
    if (corners < 3 * FINE) return part.geometry;
    const known = this.coarse.get(part) ?? coarseOf(part.geometry, CELL * (this.scene.standing_height || 0.2));
    this.coarse.set(part, known);
    return known;
  }
}

class Arrow extends Group {
  private readonly shaft: Mesh;
  private readonly head: Mesh;

  constructor(
    private readonly radius: number,
    material: MeshLambertMaterial,
  ) {
    super();
    this.shaft = new Mesh(
      new CylinderGeometry(radius, radius, 1, 10).translate(0, 0.5, 0).rotateX(Math.PI / 2),
      material,
    );
    this.head = new Mesh(new ConeGeometry(2.6 * radius, 6 * radius, 14).rotateX(Math.PI / 2), material);
    this.add(this.shaft, this.head);
  }
  /** From the origin along `vector`, which is as long as the arrow. */
  point(vector: Vector3, longest: number): void {
    vector.clampLength(0, longest);
    const length = vector.length();
    this.visible = length > 3 * this.radius;
    if (!this.visible) return;
    this.quaternion.setFromUnitVectors(UP, vector.clone().divideScalar(length));
    this.shaft.scale.z = Math.max(1e-6, length - 6 * this.radius);
    this.head.position.z = length - 3 * this.radius;
  }
}

export class RobotView extends Group {
  readonly bodies: Object3D[] = [];
  /** Centres of the feet, moving with their bodies. */
  readonly feet: Object3D[] = [];
  readonly arrows = new Group();
  readonly trails = new Group();
  readonly support: Support;
  private readonly insides: Insides;
  private seen: ReadonlySet<Inside> = new Set();
  /** Its bodies, without arrows and paths. */
  readonly solid = new Group();
  private readonly meshes: { mesh: Mesh; part: Part }[] = [];
  private readonly materials: { material: MeshLambertMaterial; own: Color }[] = [];
  private readonly arrowMaterial = new MeshLambertMaterial();
  private readonly trailMaterial = new LineBasicMaterial({ transparent: true, opacity: 0.9 });
  private readonly from = new Quaternion();
  private readonly to = new Quaternion();

  /** @param metresPerNewton of arrows */
  constructor(
    readonly run: Run,
    private readonly parts: RobotParts,
    private readonly metresPerNewton: number,
  ) {
    super();
    for (const body of parts.scene.bodies) {
      const object = new Group();
      object.name = body.name;
      this.bodies.push(object);
      this.solid.add(object);
    }
    for (const part of parts.shapes) {
      const mesh = this.meshOf(part.shape, part.geometry);
      this.meshes.push({ mesh, part });
      this.bodies[part.body]!.add(mesh);
    }
    const size = parts.scene.standing_height || 0.2;
    parts.scene.legs.forEach((leg, index) => {
      const foot = new Object3D();
      foot.name = `foot ${leg.name}`;
      foot.position.set(...leg.foot);
      this.bodies[leg.body]!.add(foot);
      this.feet.push(foot);
      this.arrows.add(new Arrow(0.03 * size, this.arrowMaterial));
      this.trails.add(this.trailOf(index));
    });
    this.support = new Support(parts.scene, size);
    this.insides = new Insides(parts.scene, parts.numbers, this.bodies);
    this.add(this.solid, this.arrows, this.trails, this.support);
  }

  /** In its own colours, or in those of the run if there are several. */
  paint(colour: string, own: boolean, ghost: boolean): void {
    const paint = new Color(colour);
    for (const { material, own: its } of this.materials) {
      // Dark parts stay darker, so that the shape can still be read.
      material.color.copy(its);
      if (!own) material.color.lerp(paint, 0.72);
      const seenThrough = ghost || this.seen.size > 0;
      material.transparent = seenThrough;
      material.opacity = seenThrough ? 0.38 : 1;
      material.needsUpdate = true;
    }
    const alone = own ? new Color("#d55e00") : paint;
    this.arrowMaterial.color.copy(alone);
    this.trailMaterial.color.copy(paint);
    this.insides.paint(alone);
    this.support.paint(paint);
    this.solid.traverse((object) => (object.castShadow = !ghost));
  }

  /** Whether meshes have few triangles. */
  set coarse(on: boolean) {
    for (const { mesh, part } of this.meshes) mesh.geometry = on ? this.parts.coarseOf(part) : part.geometry;
  }

  /** Shows these of its insides, the robot itself to be seen through. To be painted after. */
  showInsides(seen: ReadonlySet<Inside>): void {
    this.seen = seen;
    for (const inside of INSIDES) this.insides.show(inside, seen.has(inside));
  }

  /** @param share of the way to the frame behind it, 0 to 1 */
  show(frame: number, share: number): void {
    const { poses, time } = this.run;
    const next = Math.min(frame + 1, time.length - 1);
    const count = this.bodies.length;
    this.bodies.forEach((object, body) => {
      const a = POSE * (frame * count + body);
      const b = POSE * (next * count + body);
      const mixed = (k: number) => (poses[a + k] as number) * (1 - share) + (poses[b + k] as number) * share;
      object.position.set(mixed(0), mixed(1), mixed(2));
      this.from.fromArray(poses, a + 3);
      if (share > 0) this.from.slerp(this.to.fromArray(poses, b + 3), share);
      object.quaternion.copy(this.from);
    });
    this.updateMatrixWorld();
    this.showFeet(frame);
    this.support.show(this.run, frame, this.bodies);
  }

  private showFeet(frame: number): void {
    const legs = this.parts.scene.legs;
    const { feet, forces, time } = this.run;
    let first = frame;
    while (first > 0 && (time[frame] as number) - (time[first] as number) < TRAIL) --first;
    legs.forEach((leg, index) => {
      const at = 3 * (frame * legs.length + index);
      const arrow = this.arrows.children[index] as Arrow;
      arrow.position.set(feet[at]!, feet[at + 1]!, feet[at + 2]! - leg.radius);
      arrow.point(
        new Vector3(forces[at], forces[at + 1], forces[at + 2]).multiplyScalar(this.metresPerNewton),
        3 * (this.parts.scene.standing_height || 0.2),
      );
      (this.trails.children[index] as Line).geometry.setDrawRange(first, frame - first + 1);
    });
  }

  private meshOf(shape: Shape, geometry: BufferGeometry): Mesh {
    const [r, g, b] = shape.rgba ?? PLAIN;
    const own = new Color(r, g, b);
    const material = new MeshLambertMaterial({ color: own, flatShading: shape.type === "mesh" });
    this.materials.push({ material, own });
    const mesh = new Mesh(geometry, material);
    mesh.position.set(...shape.position);
    mesh.quaternion.set(...shape.quaternion);
    mesh.receiveShadow = true;
    return mesh;
  }

  /** After frames have changed: of a robot that is live. */
  refreshTrails(): void {
    this.trails.children.forEach((line, leg) => {
      const points = (line as Line).geometry.getAttribute("position") as BufferAttribute;
      this.fillTrail(points.array as Float32Array, leg);
      points.needsUpdate = true;
    });
  }

  private fillTrail(points: Float32Array, leg: number): void {
    const legs = this.parts.scene.legs.length;
    for (let i = 0; i < this.run.time.length; ++i) {
      const at = 3 * (i * legs + leg);
      points.set(this.run.feet.subarray(at, at + 3), 3 * i);
    }
  }

  private trailOf(leg: number): Line {
    const points = new Float32Array(3 * this.run.time.length);
    this.fillTrail(points, leg);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(points, 3));
    const line = new Line(geometry, this.trailMaterial);
    line.frustumCulled = false; // what is drawn of it changes
    return line;
  }
}
