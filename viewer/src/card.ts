// A primitive: its exemplars playing together, and f(p, phase) at the parameters on the sliders.
import * as THREE from "three";
import { floats, places, type Body, type Card, type Scene } from "./data";
import { button, make, short, toggle } from "./dom";
import { COARSE, Figure, FINE } from "./figure";
import { FlowPicture } from "./flow";
import { Player } from "./player";
import { around, blend, corners, type Weighed } from "./rows";
import { View } from "./world";

/** Room between the exemplars and the blend, metres. */
const BETWEEN = 0.12;
/** How far a movement may lead before the camera goes along, metres. */
const FAR = 0.8;

/** Whether a movement of a table, so many rows each, leads far from where it begins. */
function leads({ centre, points }: Body, table: Float32Array, rows: number): boolean {
  const at = (row: number, i: number): number => table[3 * (row * points + centre) + i];
  for (let row = 0; row < table.length / (3 * points); row++) {
    const first = row - (row % rows);
    if (Math.hypot(at(row, 0) - at(first, 0), at(row, 1) - at(first, 1)) > FAR) return true;
  }
  return false;
}
/** How solid an exemplar is: where all agree they add up. */
const GHOST = 0.36;

export class CardView {
  readonly player: Player;
  private readonly view: View;
  private readonly live: Figure;
  private readonly ghosts: Figure[] = [];
  private readonly bodies = new THREE.Group();
  private readonly lattice: Float32Array;
  private readonly paths: Float32Array;
  private readonly clocks: Float32Array;
  private readonly clock: Float32Array;
  private readonly values: number[];
  private readonly flow: FlowPicture | null = null;
  private readonly coordinates = new Float32Array(3);
  private nodes: Weighed[] = [];
  /** What the camera shows: places of exemplars and blends. */
  private wanted: THREE.Vector3[] = [];
  /** Whether the camera goes along, and how far it has gone. */
  private follows = false;
  private readonly place = new THREE.Vector3();

  constructor(scene: Scene, private readonly card: Card, readonly element: HTMLElement) {
    const body = scene.bodies[card.body];
    const colour = scene.palette[card.colour % scene.palette.length];
    this.lattice = places(card.lattice);
    this.paths = places(card.paths);
    this.clocks = floats(card.clock);
    this.clock = new Float32Array(card.phases);
    this.values = card.axes.map((axis) => axis.start);
    this.view = new View(`${card.name}: on the left its exemplars, on the right their blend`, [1, -0.26, 0.2]);
    this.live = new Figure(body, FINE);
    this.live.colour(colour);
    this.bodies.add(this.live.group);
    for (let i = 0; i < card.exemplars.length; i++) {
      const ghost = new Figure(body, COARSE, GHOST, i);
      ghost.colour(colour);
      this.ghosts.push(ghost);
      this.bodies.add(ghost.group);
    }
    this.view.content.add(this.bodies);
    this.player = new Player(card.name, () => this.pose());
    const port = make("div", { class: "viewport" }, this.view.canvas);
    const captions = make("div", { class: "captions" });
    const tools = make("div", { class: "tools" });
    const told = (): void => captions.replaceChildren(make("span", {}, this.counted()), tools, make("span", {}, "blend f(p, \u03c4)"));
    told();
    if (card.flow) {
      this.flow = new FlowPicture(card, card.flow, colour);
      this.flow.group.visible = false;
      this.view.content.add(this.flow.group);
      const shares = card.flow.explained.map((e) => `${Math.round(100 * e)} %`);
      const field = `Flowfield in three principal coordinates of posture (${shares.join(", ")} of the variance), each on its own scale; exemplars bold`;
      tools.append(toggle("Show the flowfield", "Flow", false, (on) => {
        this.bodies.visible = !on;
        if (on) captions.replaceChildren(make("span", { class: "field" }, field), tools);
        else told();
        if (this.flow) this.flow.group.visible = on;
        this.view.onFloor = !on;
        this.frame();
        this.pose();
      }));
    }
    tools.append(button("Reset camera and parameters", "Reset", () => {
      for (const slider of element.querySelectorAll<HTMLInputElement>(".parameter input")) slider.dispatchEvent(new Event("dblclick"));
      this.frame();
    }));
    const transport = make("div", { class: "transport" }, this.player.play, this.player.scrub, this.player.time);
    element.querySelector(".strip")?.replaceWith(port, captions, transport, ...this.sliders());
    this.arrange(body);
    this.moved();
    this.frame();
  }

  /** Puts exemplars and blend beside each other, as near as their widest postures allow. */
  private arrange(body: Body): void {
    this.follows = [this.lattice, this.paths].some((table) => leads(body, table, this.card.phases));
    const [blends, exemplars] = [this.lattice, this.paths].map((table) => Figure.places(body, table, this.follows, 120));
    const least = Math.min(...blends.map((p) => p.y));
    const most = Math.max(...exemplars.map((p) => p.y));
    const apart = Math.min(Math.max(0.5 * (BETWEEN + most - least), 0.3), 1.4);
    this.live.group.position.set(0, apart, 0);
    for (const ghost of this.ghosts) ghost.group.position.set(0, -apart, 0);
    for (const place of blends) place.y += apart;
    for (const place of exemplars) place.y -= apart;
    this.wanted = [...blends, ...exemplars];
  }

  /** The camera's usual place. */
  private frame(): void {
    this.place.set(0, 0, 0);
    const field = this.flow?.group.visible ? this.flow.corners() : null;
    this.view.show(field ?? this.wanted);
    this.follow();
  }

  /** The camera goes along with the blend, and the exemplars, which go at their own pace, come along. */
  private follow(): void {
    if (!this.follows || this.flow?.group.visible) return;
    const centre = this.live.middle();
    if (!Number.isFinite(centre.x)) return;
    const aside = new THREE.Vector3(0, -this.live.group.position.y, 0).add(centre);
    for (const ghost of this.ghosts) ghost.group.position.subVectors(aside, ghost.middle());
    this.view.move(this.place.subVectors(centre, this.place));
    this.place.copy(centre);
  }

  get visible(): boolean {
    return this.view.visible;
  }

  tick(secs: number): void {
    if (this.view.visible) this.player.tick(secs);
    this.view.draw();
  }

  private counted(): string {
    const n = this.card.exemplars.length;
    const all = n + this.card.more;
    return this.card.more > 0 ? `${n} of ${all} exemplars` : n === 1 ? "its exemplar" : `${n} exemplars`;
  }

  private sliders(): HTMLElement[] {
    return this.card.axes.map((axis, i) => {
      const told = (): string => `${short(this.values[i])}${axis.unit && ` ${axis.unit}`}`;
      const value = make("output", {}, told());
      const slider = make("input", {
        type: "range", min: String(axis.low), max: String(axis.high), step: "any", value: String(axis.start), "aria-label": axis.name,
      });
      slider.addEventListener("input", () => {
        this.values[i] = Number(slider.value);
        value.textContent = told();
        slider.setAttribute("aria-valuetext", told());
        this.moved();
      });
      slider.addEventListener("dblclick", () => {
        slider.value = String(axis.start);
        slider.dispatchEvent(new Event("input"));
      });
      const marks = this.card.exemplars.map((e) => {
        const mark = make("i", { title: e.name });
        const share = (e.parameters[i] - axis.low) / (axis.high - axis.low);
        mark.style.left = `${100 * Math.min(Math.max(share, 0), 1)}%`;
        return mark;
      });
      return make("label", { class: "parameter" }, make("span", {}, axis.name),
        make("span", { class: "slot" }, make("span", { class: "marks" }, ...marks), slider), value);
    });
  }

  /** Other parameters: another movement, of another length. */
  private moved(): void {
    const { phases } = this.card;
    this.nodes = corners(this.card.axes, this.values);
    blend(this.clocks, phases, this.nodes, this.clock);
    this.player.lasts(this.clock[phases - 1]);
  }

  /** The phase in rows of a movement, at so many seconds. */
  private phase(secs: number): number {
    const { clock } = this;
    let k = 0;
    while (k + 2 < clock.length && clock[k + 1] <= secs) k++;
    const piece = clock[k + 1] - clock[k];
    return k + (piece > 0 ? Math.min(Math.max((secs - clock[k]) / piece, 0), 1) : 0);
  }

  private pose(): void {
    const { phases } = this.card;
    const at = around(phases, this.phase(this.player.secs));
    const rows = this.nodes.flatMap(([n, w]) => at.map(([k, v]): Weighed => [n * phases + k, w * v]));
    if (this.flow?.group.visible) {
      blend(this.flow.lattice, 3, rows, this.coordinates);
      this.flow.now(this.coordinates);
    } else {
      this.live.take(this.lattice, rows);
      this.ghosts.forEach((ghost, i) => ghost.take(this.paths, at.map(([k, v]): Weighed => [i * phases + k, v])));
      this.follow();
    }
    this.view.touch();
  }
}
