// What engines make of a robot: what collides, how its mass is spread, and where its frames are.
import { AxesHelper, Color, EdgesGeometry, Group, LineBasicMaterial, LineSegments, type Object3D } from "three";
import type { Numbers, Scene, Shape } from "./document";
import { toggle } from "./dom";
import { geometryOf } from "./geometry";

export const INSIDES = ["collision", "inertia", "frames"] as const;
export type Inside = (typeof INSIDES)[number];
/** What each shows, in words. */
const WORDS: Record<Inside, string> = {
  collision: "Shapes that collide with the ground",
  inertia: "In green, boxes of the mass and the moments of every link",
  frames: "Axes of every link's frame: x red, y green, z blue",
};
/** Switches for what is seen of them. */
export function insideToggles(seen: Set<Inside>, changed: () => void): HTMLElement[] {
  return INSIDES.map((inside) =>
    toggle(inside, WORDS[inside], false, (on) => {
      if (on) seen.add(inside);
      else seen.delete(inside);
      changed();
    }),
  );
}

const FRAME = 0.2; // standing heights
const SHARP = 15; // degrees between faces, from which on an edge is drawn

/** The insides of one robot, moving with its bodies; each is made when it is first shown. */
export class Insides {
  private readonly made = new Map<Inside, Group[]>();
  private readonly ofCollision = new LineBasicMaterial({ depthTest: false, transparent: true });
  private readonly ofInertia = new LineBasicMaterial({ depthTest: false, transparent: true, color: "#009e73" });

  constructor(
    private readonly scene: Scene,
    private readonly numbers: Numbers,
    private readonly bodies: Object3D[],
  ) {}

  paint(colour: Color): void {
    this.ofCollision.color.copy(colour);
  }

  show(inside: Inside, on: boolean): void {
    if (on && !this.made.has(inside)) this.made.set(inside, this.make(inside));
    for (const group of this.made.get(inside) ?? []) group.visible = on;
  }

  private make(inside: Inside): Group[] {
    return this.scene.bodies.map((body, i) => {
      const group = new Group();
      group.name = inside;
      group.renderOrder = 1;
      if (inside === "frames") group.add(this.axes());
      if (inside === "collision") for (const shape of body.collision) group.add(this.edgesOf(shape, this.ofCollision));
      if (inside === "inertia") group.add(this.edgesOf(body.inertia, this.ofInertia));
      this.bodies[i]!.add(group);
      return group;
    });
  }

  private axes(): AxesHelper {
    const axes = new AxesHelper(FRAME * (this.scene.standing_height || 0.2));
    Object.assign(axes.material, { depthTest: false, transparent: true });
    return axes;
  }

  private edgesOf(shape: Shape, material: LineBasicMaterial): LineSegments {
    const geometry = geometryOf(shape, this.scene, this.numbers);
    const edges = new LineSegments(new EdgesGeometry(geometry, SHARP), material);
    geometry.dispose();
    edges.position.set(...shape.position);
    edges.quaternion.set(...shape.quaternion);
    return edges;
  }
}
