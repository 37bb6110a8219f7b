// What all views share: one renderer, the light, the floor.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const dark = matchMedia("(prefers-color-scheme: dark)");
export const still = matchMedia("(prefers-reduced-motion: reduce)");

/** The colour of what has no colour of its own. */
export function neutral(): string {
  return dark.matches ? "#c2c9d1" : "#b4bdc7";
}

const FLOOR = `
  varying vec2 place;
  uniform vec3 ink;
  uniform vec2 focus;
  uniform float reach;
  float lines(float pitch, float width) {
    vec2 at = place / pitch;
    vec2 off = abs(fract(at - 0.5) - 0.5) / fwidth(at);
    return 1.0 - min(min(off.x, off.y) / width, 1.0);
  }
  void main() {
    float fade = 1.0 - smoothstep(0.25, 1.0, length(place - focus) / reach);
    float shade = max(0.30 * lines(1.0, 1.3), 0.13 * lines(0.25, 1.1));
    gl_FragColor = vec4(ink, shade * fade);
  }`;

class World {
  readonly scene = new THREE.Scene();
  readonly floor = new THREE.Group();
  private readonly renderer: THREE.WebGLRenderer;
  private readonly grid: THREE.ShaderMaterial;
  private readonly shadow = new THREE.ShadowMaterial();
  private readonly sun = new THREE.DirectionalLight(0xfffaf2, 2.7);
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0xa39d97, 2.2);
  private width = 0;
  private height = 0;

  constructor() {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.setScissorTest(true);
    this.sky.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 5;
    this.sun.shadow.normalBias = 0.012;
    this.sun.shadow.bias = -0.0008;
    this.grid = new THREE.ShaderMaterial({
      vertexShader: `varying vec2 place;
        void main() { place = (modelMatrix * vec4(position, 1.0)).xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
      fragmentShader: FLOOR,
      uniforms: { ink: { value: new THREE.Color() }, focus: { value: new THREE.Vector2() }, reach: { value: 6 } },
      transparent: true,
      depthWrite: false,
    });
    const plane = new THREE.PlaneGeometry(80, 80);
    const ground = new THREE.Mesh(plane, this.shadow);
    ground.receiveShadow = true;
    const grid = new THREE.Mesh(plane, this.grid);
    grid.position.z = -0.001;
    this.floor.add(grid, ground);
    this.scene.add(this.floor, this.sky, this.sun, this.sun.target);
    const theme = (): void => {
      (this.grid.uniforms.ink.value as THREE.Color).set(dark.matches ? "#9fb0c2" : "#3c4a5a");
      this.shadow.opacity = dark.matches ? 0.55 : 0.26;
      this.sky.intensity = dark.matches ? 1.5 : 2.2;
    };
    theme();
    dark.addEventListener("change", theme);
  }

  /** Draws what is in `content` onto a canvas; light and floor are where `focus` is, `reach` metres about it. */
  draw(canvas: HTMLCanvasElement, content: THREE.Object3D, camera: THREE.Camera, focus: THREE.Vector3, reach: number): void {
    const { width, height } = canvas;
    if (width === 0 || height === 0) return;
    // The buffer only grows: views of several sizes take turns in it.
    if (width > this.width || height > this.height) {
      this.width = Math.max(width, this.width);
      this.height = Math.max(height, this.height);
      this.renderer.setSize(this.width, this.height, false);
    }
    this.renderer.setViewport(0, 0, width, height);
    this.renderer.setScissor(0, 0, width, height);
    (this.grid.uniforms.focus.value as THREE.Vector2).set(focus.x, focus.y);
    this.grid.uniforms.reach.value = 2.4 * reach;
    const frustum = this.sun.shadow.camera;
    frustum.left = frustum.bottom = -reach;
    frustum.right = frustum.top = reach;
    frustum.far = 8 * reach;
    frustum.updateProjectionMatrix();
    this.sun.target.position.set(focus.x, focus.y, 0.6);
    this.sun.position.set(focus.x + 1.3 * reach, focus.y - 1.1 * reach, 0.6 + 3 * reach);
    this.scene.add(content);
    this.renderer.render(this.scene, camera);
    this.scene.remove(content);
    const paper = canvas.getContext("2d");
    if (!paper) return;
    paper.clearRect(0, 0, width, height);
    paper.drawImage(this.renderer.domElement, 0, this.height - height, width, height, 0, 0, width, height);
  }
}

let world: World | null = null;

/** Pixels of a picture to a pixel of the page: fewer where drawing is slow. */
let sharpness = 2;
let typical: number | null = null;
const views: View[] = [];

/** Learns how many milliseconds the pictures of a frame took. */
export function slow(ms: number): void {
  // The first picture compiles what the others only use.
  typical = typical === null ? 0 : 0.8 * typical + 0.2 * ms;
  if (typical < 45 || sharpness <= 0.75) return;
  sharpness = sharpness > 1 ? 1 : 0.75;
  typical = null;
  for (const view of views) view.touch();
}

/** The share of a picture that bodies may fill. */
const ROOM = 0.93;

/** A canvas with a camera that the reader can turn. */
export class View {
  readonly canvas = document.createElement("canvas");
  readonly content = new THREE.Group();
  readonly camera = new THREE.PerspectiveCamera(30, 1, 0.05, 100);
  readonly controls: OrbitControls;
  /** Metres about the focus that matter. */
  reach = 1.6;
  visible = false;
  /** Whether there is a floor to stand on. */
  onFloor = true;
  private stale = true;
  private drawn = 0;
  /** Pixels at its top that are to stay free. */
  clear = 0;
  private readonly home: THREE.Vector3;
  private wanted: THREE.Vector3[] = [];
  /** How far it has been moved since. */
  private readonly shift = new THREE.Vector3();
  /** Whether the reader has turned it. */
  private moved = false;

  constructor(label: string, from: [number, number, number] = [1, -0.62, 0.24]) {
    this.home = new THREE.Vector3(...from);
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 25;
    this.controls.enableZoom = false;
    this.controls.addEventListener("change", () => (this.stale = true));
    this.controls.addEventListener("start", () => (this.moved = true));
    // A page that scrolls must not be caught by a picture: the wheel zooms with a key held, or after a click.
    this.canvas.addEventListener("pointerdown", () => (this.controls.enableZoom = true));
    this.canvas.addEventListener("pointerleave", () => (this.controls.enableZoom = false));
    this.canvas.style.touchAction = "pan-y";
    views.push(this);
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    new IntersectionObserver((seen) => {
      this.visible = seen[seen.length - 1].isIntersecting;
      this.stale = true;
    }).observe(this.canvas);
    dark.addEventListener("change", () => (this.stale = true));
  }

  touch(): void {
    this.stale = true;
  }

  /** Looks from its usual side at what is to be seen, from so near that all of it is. */
  show(wanted: THREE.Vector3[]): void {
    this.wanted = wanted;
    this.shift.set(0, 0, 0);
    this.reset();
  }

  reset(): void {
    this.moved = false;
    const toward = this.home.clone().normalize();
    const across = new THREE.Vector3().crossVectors(this.camera.up, toward).normalize();
    const upright = new THREE.Vector3().crossVectors(toward, across);
    const depths = this.wanted.map((p) => p.dot(toward));
    const depth = 0.5 * (Math.min(...depths) + Math.max(...depths));
    if (!Number.isFinite(depth)) return;
    const half = Math.tan(THREE.MathUtils.degToRad(0.5 * this.camera.fov)) * ROOM;
    const top = half * Math.max(1 - (2 * this.clear) / Math.max(this.canvas.clientHeight, 1), 0.3);
    const wide = half * this.camera.aspect;
    const [right, middle] = [fit(this.wanted, across, depths, depth, wide, wide), fit(this.wanted, upright, depths, depth, top, half)];
    const away = Math.min(Math.max(right.away, middle.away, 1.5), 16);
    this.controls.target.copy(toward).multiplyScalar(depth)
      .addScaledVector(across, right.centre(away)).addScaledVector(upright, middle.centre(away));
    this.camera.position.copy(this.controls.target).addScaledVector(toward, away);
    this.reach = Math.max(1.7, ...this.wanted.map((p) => Math.hypot(p.x - this.controls.target.x, p.y - this.controls.target.y)));
    this.controls.target.add(this.shift);
    this.camera.position.add(this.shift);
    this.settle();
  }

  /** Moves camera and target together. */
  move(by: THREE.Vector3): void {
    this.camera.position.add(by);
    this.controls.target.add(by);
    this.shift.add(by);
    this.settle();
  }

  /** The controls take the camera as it is; that is no turn of the reader's. */
  private settle(): void {
    this.controls.update();
    this.stale = true;
  }

  /** Turns about the target, or comes nearer: for keys. */
  turn(by: number, nearer: number): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(this.camera.up, by).multiplyScalar(nearer);
    this.camera.position.copy(this.controls.target).add(arm);
    this.moved = true;
    this.settle();
  }

  /** Draws if there is something new to see. */
  draw(): void {
    if (!this.stale || !this.visible) return;
    this.stale = false;
    const [width, height] = this.size();
    if (this.canvas.width !== width || this.canvas.height !== height) {
      // Only now: a canvas of another size is empty until something is drawn.
      this.canvas.width = width;
      this.canvas.height = height;
    }
    world ??= new World();
    world.floor.visible = this.onFloor;
    world.draw(this.canvas, this.content, this.camera, this.controls.target, this.reach);
    this.drawn += 1;
    // Who tests the page waits for this.
    this.canvas.dataset.drawn = String(this.drawn);
  }

  private size(): [number, number] {
    const sharp = Math.min(devicePixelRatio, sharpness);
    return [Math.round(this.canvas.clientWidth * sharp), Math.round(this.canvas.clientHeight * sharp)];
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientHeight > 0) this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (this.moved) this.stale = true;
    else this.reset();
  }
}

/** How far off a camera must be to see all places along one direction, and where its middle is then. */
function fit(places: THREE.Vector3[], along: THREE.Vector3, depths: number[], depth: number, above: number, below: number): { away: number; centre(away: number): number } {
  let [high, low] = [-Infinity, Infinity];
  places.forEach((place, i) => {
    const [at, nearer] = [place.dot(along), depths[i] - depth];
    high = Math.max(high, at + nearer * above);
    low = Math.min(low, at - nearer * below);
  });
  return {
    away: (high - low) / (above + below),
    centre: (away) => 0.5 * (high - away * above + low + away * below),
  };
}
