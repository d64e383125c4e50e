// The geometry of a shape, as three.js has it.
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  SphereGeometry,
  Vector3,
} from "three";
import { ConvexGeometry } from "three/addons/geometries/ConvexGeometry.js";
import type { Numbers, Scene, Shape } from "./document";

export function geometryOf(shape: Shape, scene: Scene, numbers: Numbers): BufferGeometry {
  const [a, b, c] = shape.size;
  switch (shape.type) {
    case "box":
      return new BoxGeometry(2 * a, 2 * b, 2 * c);
    case "sphere":
      return new SphereGeometry(a, 24, 16);
    case "cylinder": // three.js has its axis along y
      return new CylinderGeometry(a, a, 2 * b, 24).rotateX(Math.PI / 2);
    case "capsule":
      return new CapsuleGeometry(a, 2 * b, 8, 20).rotateX(Math.PI / 2);
    case "hull": {
      const xyz = numbers.floats(shape.vertices!);
      const points: Vector3[] = [];
      for (let i = 0; i < xyz.length; i += 3) points.push(new Vector3(xyz[i], xyz[i + 1], xyz[i + 2]));
      return new ConvexGeometry(points);
    }
    case "mesh": {
      const mesh = scene.meshes[shape.mesh!]!;
      const geometry = new BufferGeometry();
      // A copy, since it is scaled: other shapes and other replays show the same mesh.
      geometry.setAttribute("position", new BufferAttribute(numbers.floats(mesh.vertices).slice(), 3));
      geometry.setIndex(new BufferAttribute(numbers.indices(mesh.triangles), 1));
      geometry.scale(...shape.scale!);
      geometry.computeVertexNormals();
      return geometry;
    }
  }
}
