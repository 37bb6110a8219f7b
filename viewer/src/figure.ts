// A body: round cones between moving points, as one mesh.
import * as THREE from "three";
import type { Body } from "./data";
import { blendPosture, outward, type Weighed } from "./rows";

interface Detail {
  /** Vertices around a bone. */
  around: number;
  /** Rings of vertices at each end. */
  rings: number;
}

export const FINE: Detail = { around: 16, rings: 5 };
export const COARSE: Detail = { around: 10, rings: 4 };

export class Figure {
  readonly group = new THREE.Group();
  readonly points: Float32Array;
  private readonly positions: THREE.BufferAttribute;
  private readonly normals: THREE.BufferAttribute;
  private readonly material: THREE.MeshStandardMaterial;
  private readonly circle: Float32Array;
  private readonly order: number[];

  /** `ghost`: how solid it is, if it is seen through; `layer`: which of several ghosts that stand in one another, none of which hides another. */
  constructor(private readonly body: Body, private readonly detail: Detail, ghost: number | null = null, layer: number | null = null) {
    this.points = new Float32Array(3 * body.points);
    this.order = outward(body);
    const columns = detail.around + 1;
    const perBone = 2 * detail.rings * columns;
    const count = body.bones.length * perBone;
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
    this.normals = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
    this.circle = new Float32Array(2 * columns);
    for (let c = 0; c < columns; c++) {
      const angle = (2 * Math.PI * c) / detail.around;
      this.circle.set([Math.cos(angle), Math.sin(angle)], 2 * c);
    }
    const index: number[] = [];
    for (let bone = 0; bone < body.bones.length; bone++) {
      for (let ring = 0; ring + 1 < 2 * detail.rings; ring++) {
        for (let c = 0; c < detail.around; c++) {
          const a = bone * perBone + ring * columns + c;
          index.push(a, a + 1, a + columns, a + 1, a + columns + 1, a + columns);
        }
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute("normal", this.normals);
    geometry.setIndex(index);
    this.material = new THREE.MeshStandardMaterial({ roughness: 0.62, metalness: 0 });
    const mesh = new THREE.Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    if (ghost !== null) {
      // Depth first, colour after: of what is seen through only the nearest surface shows.
      const depth = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true }));
      depth.frustumCulled = false;
      depth.renderOrder = 1 + 2 * (layer ?? 0);
      mesh.renderOrder = depth.renderOrder + 1;
      if (layer !== null) {
        depth.onBeforeRender = (renderer) => {
          renderer.state.buffers.depth.setMask(true);
          renderer.clearDepth();
        };
      }
      this.material.transparent = true;
      this.material.opacity = ghost;
      this.material.depthWrite = false;
      this.group.add(depth);
    } else {
      mesh.castShadow = true;
      mesh.receiveShadow = true;
    }
    this.group.add(mesh);
  }

  colour(colour: THREE.ColorRepresentation): void {
    this.material.color.set(colour);
  }

  /** Where the body's centre is. */
  centre(out: THREE.Vector3): THREE.Vector3 {
    return out.fromArray(this.points, 3 * this.body.centre).add(this.group.position);
  }

  /** The place on the floor below the body's centre, as its postures have it. */
  middle(): THREE.Vector3 {
    return new THREE.Vector3().fromArray(this.points, 3 * this.body.centre).setZ(0);
  }

  /** Some of the places that a table's postures take up; each seen from below its own centre if the body is followed. */
  static places({ centre, points }: Body, table: Float32Array, followed: boolean, most = 40): THREE.Vector3[] {
    const rows = table.length / (3 * points);
    const step = Math.max(1, Math.floor(rows / most));
    const found: THREE.Vector3[] = [];
    for (let row = 0; row < rows; row += step) {
      const middle = new THREE.Vector3().fromArray(table, 3 * (row * points + centre)).setZ(0);
      for (let i = 0; i < points; i++) {
        const place = new THREE.Vector3().fromArray(table, 3 * (row * points + i));
        if (followed) place.sub(middle);
        if (Number.isFinite(place.x + place.y + place.z)) found.push(place);
      }
    }
    return found;
  }

  /** Draws the body between rows of a table of its postures. */
  take(table: Float32Array, rows: Weighed[]): void {
    blendPosture(table, this.body, this.order, rows, this.points);
    this.update();
  }

  /** Draws the body at its points. */
  private update(): void {
    const { around, rings } = this.detail;
    const position = this.positions.array as Float32Array;
    const normal = this.normals.array as Float32Array;
    const p = this.points;
    let v = 0;
    for (const { ends: [a, b], radii: [ra, rb] } of this.body.bones) {
      const ax = p[3 * a], ay = p[3 * a + 1], az = p[3 * a + 2];
      const bx = p[3 * b], by = p[3 * b + 1], bz = p[3 * b + 2];
      let wx = bx - ax, wy = by - ay, wz = bz - az;
      const length = Math.hypot(wx, wy, wz);
      if (Number.isNaN(length)) {
        const end = v + 6 * rings * (around + 1);
        position.fill(0, v, end);
        v = end;
        continue;
      }
      if (length > 1e-9) {
        wx /= length, wy /= length, wz /= length;
      } else {
        wx = 0, wy = 0, wz = 1;
      }
      // Any two directions across the bone: it is round.
      const [hx, hy, hz] = Math.abs(wz) < 0.9 ? [0, 0, 1] : [1, 0, 0];
      let ux = hy * wz - hz * wy, uy = hz * wx - hx * wz, uz = hx * wy - hy * wx;
      const across = Math.hypot(ux, uy, uz);
      ux /= across, uy /= across, uz /= across;
      const vx = wy * uz - wz * uy, vy = wz * ux - wx * uz, vz = wx * uy - wy * ux;
      // The elevation at which the cone touches both spheres.
      const touch = Math.asin(Math.max(-1, Math.min(1, (ra - rb) / Math.max(length, 1e-9))));
      for (let ring = 0; ring < 2 * rings; ring++) {
        const first = ring < rings;
        const share = (first ? ring : ring - rings) / (rings - 1);
        const elevation = first ? -Math.PI / 2 + share * (touch + Math.PI / 2) : touch + share * (Math.PI / 2 - touch);
        const up = Math.sin(elevation), out = Math.cos(elevation);
        const cx = first ? ax : bx, cy = first ? ay : by, cz = first ? az : bz;
        const r = first ? ra : rb;
        for (let c = 0; c <= around; c++) {
          const cos = out * this.circle[2 * c], sin = out * this.circle[2 * c + 1];
          const nx = cos * ux + sin * vx + up * wx;
          const ny = cos * uy + sin * vy + up * wy;
          const nz = cos * uz + sin * vz + up * wz;
          normal[v] = nx, normal[v + 1] = ny, normal[v + 2] = nz;
          position[v] = cx + r * nx, position[v + 1] = cy + r * ny, position[v + 2] = cz + r * nz;
          v += 3;
        }
      }
    }
    this.positions.needsUpdate = true;
    this.normals.needsUpdate = true;
  }
}
