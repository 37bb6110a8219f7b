// The flowfield of a primitive in three principal coordinates of posture.
import * as THREE from "three";
import { floats, type Card, type Flow } from "./data";
import { neutral } from "./world";

/** Metres that the field's extent along each coordinate becomes: the later ones would hardly be seen at the first's scale. */
const SIZES = [2.6, 1.5, 1.3];
/** The height of its middle. */
const HEIGHT = 0.92;

export class FlowPicture {
  readonly group = new THREE.Group();
  readonly lattice: Float32Array;
  private readonly dot: THREE.Mesh;
  private readonly scale = new THREE.Vector3();
  private readonly middle = new THREE.Vector3();

  constructor(card: Card, flow: Flow, colour: string) {
    this.lattice = floats(flow.lattice);
    const exemplars = floats(flow.exemplars);
    const box = new THREE.Box3();
    for (const table of [this.lattice, exemplars]) {
      for (let i = 0; i < table.length; i += 3) box.expandByPoint(new THREE.Vector3().fromArray(table, i));
    }
    box.getCenter(this.middle);
    const extent = box.getSize(new THREE.Vector3());
    // A coordinate along which nothing differs stays flat.
    const least = 1e-3 * Math.max(extent.x, extent.y, extent.z, 1e-9);
    this.scale.fromArray(extent.toArray().map((e, i) => SIZES[i] / Math.max(e, least)));
    this.group.add(this.arrows(card, colour), ...this.axes());
    const bold = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.6 });
    for (let e = 0; e < card.exemplars.length; e++) {
      const points = Array.from({ length: card.phases }, (_, k) => this.at(exemplars, e * card.phases + k));
      const curve = new THREE.CatmullRomCurve3(points);
      this.group.add(new THREE.Mesh(new THREE.TubeGeometry(curve, 2 * card.phases, 0.014, 6), bold));
    }
    this.dot = new THREE.Mesh(new THREE.SphereGeometry(0.045, 20, 14), new THREE.MeshStandardMaterial({ roughness: 0.4 }));
    this.group.add(this.dot);
  }

  /** The corners of the box that it fills. */
  corners(): THREE.Vector3[] {
    const signs = [-0.5, 0.5];
    const corner = (x: number, y: number, z: number): THREE.Vector3 => new THREE.Vector3(z * SIZES[2], x * SIZES[0], y * SIZES[1] + HEIGHT);
    return signs.flatMap((x) => signs.flatMap((y) => signs.map((z) => corner(x, y, z))));
  }

  /** Where the movement is now, in the field's own coordinates. */
  now(coordinates: Float32Array): void {
    this.dot.position.copy(this.at(coordinates, 0));
    (this.dot.material as THREE.MeshStandardMaterial).color.set(neutral());
  }

  private at(table: Float32Array, row: number): THREE.Vector3 {
    const place = new THREE.Vector3().fromArray(table, 3 * row).sub(this.middle).multiply(this.scale);
    // The coordinate of most variance lies across, the second upright, the third in depth.
    return new THREE.Vector3(place.z, place.x, place.y + HEIGHT);
  }

  /** An arrow at every second phase of every node of the grid, along the movement. */
  private arrows(card: Card, colour: string): THREE.Object3D {
    const rows = this.lattice.length / 3;
    const places: [THREE.Vector3, THREE.Vector3][] = [];
    for (let row = 0; row + 1 < rows; row++) {
      const phase = row % card.phases;
      if (phase % 2 === 1 || phase === card.phases - 1) continue;
      places.push([this.at(this.lattice, row), this.at(this.lattice, row + 1)]);
    }
    const cone = new THREE.ConeGeometry(0.02, 0.09, 6);
    const material = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.8, transparent: true, opacity: 0.5 });
    const mesh = new THREE.InstancedMesh(cone, material, places.length);
    const up = new THREE.Vector3(0, 1, 0);
    const turn = new THREE.Quaternion();
    const matrix = new THREE.Matrix4();
    places.forEach(([from, to], i) => {
      const along = to.clone().sub(from);
      const length = along.length();
      turn.setFromUnitVectors(up, length > 0 ? along.divideScalar(length) : up);
      const size = Math.min(Math.max(length / 0.1, 0.4), 1.8);
      matrix.compose(from, turn, new THREE.Vector3(0.8, size, 0.8));
      mesh.setMatrixAt(i, matrix);
    });
    mesh.frustumCulled = false;
    return mesh;
  }

  private axes(): THREE.Object3D[] {
    const corner = new THREE.Vector3(-SIZES[2] / 2, -SIZES[0] / 2, HEIGHT - SIZES[1] / 2);
    const ends = [[0, 1, 0], [0, 0, 1], [1, 0, 0]].map((d) => new THREE.Vector3(...(d as [number, number, number])));
    return ends.map((along, i) => {
      const geometry = new THREE.CylinderGeometry(0.004, 0.004, SIZES[i], 5);
      const bar = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: "#8a929b" }));
      bar.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
      bar.position.copy(corner).addScaledVector(along, SIZES[i] / 2);
      return bar;
    });
  }
}
