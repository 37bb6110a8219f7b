// The stage: one take at a time, its actors in three dimensions, its tracks beneath.
import * as THREE from "three";
import { places, type Actor, type Scene, type Take } from "./data";
import { button, Choice, make, toggle } from "./dom";
import { Figure, FINE } from "./figure";
import { Player } from "./player";
import { around } from "./rows";
import { Timeline } from "./timeline";
import { neutral, still, View } from "./world";

interface Playing {
  actor: Actor;
  figure: Figure;
  frames: Float32Array;
  colour: THREE.Color;
  shown: boolean;
}

/** Seconds in which a colour comes and goes. */
const FADE = 0.1;
/** Moments of a take that the camera's usual place is made for. */
const MOMENTS = 32;
/** Pixels that buttons over a narrow picture take. */
const TOOLS = 46;
/** What keys do, told to who asks. */
const KEYS = [
  ["Space", "play or pause"], ["\u2190 \u2192", "step; with Shift a second"], ["Home End", "beginning, end"], ["+ \u2212", "faster, slower"],
  ["A D", "turn"], ["W S", "nearer, farther"], ["N P", "next and previous motion"],
];

export class Stage {
  readonly player: Player;
  private readonly view = new View("Bodies in motion; drag to turn, scroll to come nearer after a click");
  private readonly timeline: Timeline;
  private readonly legend = make("div", { class: "legend", role: "group", "aria-label": "Bodies" });
  private readonly note = make("p", { class: "note" });
  private readonly beside: HTMLButtonElement;
  private readonly choice: Choice | null = null;
  private readonly focus = new THREE.Vector3();
  private readonly before = new THREE.Vector3();
  private playing: Playing[] = [];
  private take: Take;
  private following = true;
  private apart = true;

  constructor(private readonly scene: Scene, private readonly section: HTMLElement) {
    this.take = scene.takes[0];
    this.timeline = new Timeline(scene.palette, (secs) => this.player.put(secs));
    this.player = new Player("the motion", () => this.pose());
    this.beside = toggle("Stand side by side", "Side by side", true, (on) => {
      this.apart = on;
      this.pose();
      this.frame();
    });
    const keys = make("dl", { class: "keys" }, ...KEYS.flatMap(([key, what]) => [make("dt", {}, key), make("dd", {}, what)]));
    keys.hidden = true;
    const tools = make("div", { class: "tools" },
      this.beside,
      toggle("Follow the body", "Follow", true, (on) => {
        this.following = on;
        if (on) this.frame();
        this.pose();
      }),
      button("Reset the camera", "Reset", () => this.frame()),
      this.player.speeds,
      toggle("Show what keys do", "Keys", false, (on) => (keys.hidden = !on)),
    );
    const port = make("div", { class: "viewport", tabindex: "0", role: "group", "aria-label": "The stage: space plays, arrows step, A and D turn, W and S come nearer and go farther" },
      this.view.canvas, this.legend, tools, keys);
    port.addEventListener("keydown", (event) => this.turned(event));
    if (scene.takes.length > 1) {
      this.choice = new Choice("Motion", scene.takes.map((take) => take.name), (i) => this.show(scene.takes[i]));
      section.append(this.choice.element);
    }
    const transport = make("div", { class: "transport" }, make("div", { class: "gutter" }, this.player.play, this.player.time), this.player.scrub);
    section.append(port, transport, this.timeline.element, this.note);
    this.show(this.take);
  }

  get element(): HTMLElement {
    return this.section;
  }

  /** Plays a take from a moment on, where the reader can see it. */
  play(take: number, secs: number): void {
    if (this.choice) this.choice.choose(take);
    this.player.put(secs);
    if (!still.matches) this.player.run(true);
    this.section.scrollIntoView({ block: "start", behavior: still.matches ? "auto" : "smooth" });
    this.section.querySelector<HTMLElement>(".viewport")?.focus({ preventScroll: true });
  }

  tick(secs: number): void {
    if (this.view.visible) this.player.tick(secs);
    this.view.draw();
  }

  private show(take: Take): void {
    this.take = take;
    this.view.content.clear();
    this.legend.replaceChildren();
    this.playing = take.actors.map((actor) => {
      const body = this.scene.bodies[actor.body];
      const figure = new Figure(body, FINE, actor.ghost ? 0.38 : null);
      this.view.content.add(figure.group);
      const playing: Playing = { actor, figure, frames: places(actor.frames), colour: new THREE.Color(), shown: true };
      if (take.actors.length > 1) this.legend.append(this.entry(playing));
      return playing;
    });
    this.beside.hidden = take.actors.every((a) => a.aside.every((c) => c === 0));
    this.note.textContent = take.note;
    this.note.hidden = take.note === "";
    this.timeline.show(take);
    this.player.secs = 0;
    this.player.lasts(take.secs);
    this.player.put(0);
    this.frame();
  }

  private entry(playing: Playing): HTMLElement {
    const box = make("input", { type: "checkbox", checked: "" });
    box.addEventListener("change", () => {
      playing.shown = box.checked;
      this.pose();
    });
    const { colour, ghost, name } = playing.actor;
    const chip = make("i", { class: ghost ? "chip ghost" : "chip" });
    chip.style.background = colour === null ? "var(--none)" : this.scene.palette[colour % this.scene.palette.length];
    // A colour of its own tells a body from the others, and so does being seen through.
    return make("label", {}, box, ...(colour !== null || ghost ? [chip] : []), name);
  }

  /** The colour of an actor at a moment: its own, or that of what it does, which comes and goes in a tenth of a second. */
  private dress({ actor, colour }: Playing, secs: number): THREE.Color {
    colour.set(actor.colour === null ? neutral() : this.scene.palette[actor.colour % this.scene.palette.length]);
    const track = actor.wears === null ? undefined : this.take.tracks[actor.wears];
    if (track?.kind !== "spans") return colour;
    for (const span of track.spans) {
      if (span.colour === null || secs < span.start || secs > span.end) continue;
      const there = Math.min(1, (secs - span.start) / FADE, (span.end - secs) / FADE);
      return colour.lerp(new THREE.Color(this.scene.palette[span.colour % this.scene.palette.length]), 0.85 * there);
    }
    return colour;
  }

  /** Puts every body into its posture of the moment. */
  private pose(): void {
    const secs = this.player.secs;
    this.timeline.now(secs);
    for (const playing of this.playing) {
      const { actor, figure, frames, shown } = playing;
      const at = (secs - actor.start_secs) * actor.rate_hz;
      const here = at > -1 && at < actor.frames.rows;
      figure.group.visible = shown && here;
      if (!figure.group.visible) continue;
      figure.take(frames, around(actor.frames.rows, at));
      figure.group.position.fromArray(this.apart ? actor.aside : [0, 0, 0]);
      figure.colour(this.dress(playing, secs));
    }
    if (this.following) {
      this.middle(this.focus);
      if (Number.isFinite(this.focus.x)) {
        this.view.move(this.before.subVectors(this.focus, this.before));
        this.before.copy(this.focus);
      }
    }
    this.view.touch();
  }

  /** The middle of the bodies' centres. */
  private middle(out: THREE.Vector3): void {
    out.set(0, 0, 0);
    const centre = new THREE.Vector3();
    let count = 0;
    for (const { figure } of this.playing) {
      if (!figure.group.visible || Number.isNaN(figure.centre(centre).x)) continue;
      out.add(centre);
      count += 1;
    }
    out.divideScalar(count).setZ(0);
  }

  /** The camera's usual place: whoever moves stays in sight, at all times if the camera goes along. */
  private frame(): void {
    this.middle(this.focus);
    if (!Number.isFinite(this.focus.x)) this.focus.set(0, 0, 0);
    this.before.copy(this.focus);
    const moments = Array.from({ length: MOMENTS }, (_, i) => (i * this.take.secs) / (MOMENTS - 1));
    this.view.clear = this.view.canvas.clientWidth < 660 ? TOOLS : 0;
    this.view.show(moments.flatMap((secs) => this.seen(secs)));
  }

  /** Where the points of all bodies are at a moment, as if their middle were where it is now. */
  private seen(secs: number): THREE.Vector3[] {
    const middle = new THREE.Vector3();
    const places: THREE.Vector3[] = [];
    let bodies = 0;
    for (const { actor, frames, shown } of this.playing) {
      const row = Math.round((secs - actor.start_secs) * actor.rate_hz);
      if (!shown || row < 0 || row >= actor.frames.rows) continue;
      const { points, centre } = this.scene.bodies[actor.body];
      const aside = new THREE.Vector3().fromArray(this.apart ? actor.aside : [0, 0, 0]);
      const place = (i: number): THREE.Vector3 => new THREE.Vector3().fromArray(frames, 3 * (row * points + i)).add(aside);
      if (!Number.isFinite(place(centre).x)) continue;
      middle.add(place(centre));
      bodies += 1;
      for (let i = 0; i < points; i++) places.push(place(i));
    }
    middle.divideScalar(Math.max(bodies, 1)).setZ(0);
    for (const place of places) place.sub(middle).add(this.focus);
    return places.filter((place) => Number.isFinite(place.x + place.y + place.z));
  }

  private turned(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    if (this.choice && (key === "n" || key === "p")) return void this.choice.step(key === "n" ? 1 : -1);
    const turns: Record<string, [number, number]> = { a: [-0.12, 1], d: [0.12, 1], w: [0, 0.92], s: [0, 1.08] };
    const turn = turns[key];
    if (!turn) return;
    this.view.turn(...turn);
    event.preventDefault();
  }
}
